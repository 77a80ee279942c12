/* Which triangles share edges (scene/adjacency.h). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/error.h"
#include "made_scene.h"
#include "scene/adjacency.h"

static struct scene *scene_of(const float (*points)[3], uint32_t count)
{
    struct scene *scene = made_scene();
    made_triangles(scene, points, count, made_material(scene, true));
    made_finish(scene);
    return scene;
}

static void check(struct scene *scene, const uint32_t *expected)
{
    struct error err = {0};
    struct adjacency a;
    assert_true(adjacency_init(&a, scene, &err));
    assert_int_equal(a.count, scene->index_count);
    for (size_t i = 0; i < a.count; i++)
        assert_int_equal(a.across[i], expected[i]);
    adjacency_finish(&a);
    scene_destroy(scene);
}

/* Loose triangles repeat their vertices: they are joined by position, -0 and 0 alike. */
static void test_positions_join(void **state)
{
    (void)state;
    const float points[9][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, -0.0f}, {1, 1, 0},
                                {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}};
    const uint32_t expected[9] = {SCENE_NONE, 1, SCENE_NONE, 2, SCENE_NONE, 0, SCENE_NONE, SCENE_NONE, 1};
    check(scene_of(points, 9), expected);
}

static void test_edges_of_three_join_none(void **state)
{
    (void)state;
    const float points[9][3] = {{0, 0, 0},  {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0},
                                {0, -1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
    const uint32_t expected[9] = {SCENE_NONE, SCENE_NONE, SCENE_NONE, SCENE_NONE, SCENE_NONE,
                                  SCENE_NONE, SCENE_NONE, SCENE_NONE, SCENE_NONE};
    check(scene_of(points, 9), expected);
}

static void test_repeated_corners_are_no_edges(void **state)
{
    (void)state;
    const float points[6][3] = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}};
    const uint32_t expected[6] = {SCENE_NONE, SCENE_NONE, SCENE_NONE, SCENE_NONE, SCENE_NONE, SCENE_NONE};
    check(scene_of(points, 6), expected);
}

static void test_links_are_mutual(void **state)
{
    (void)state;
    struct error err = {0};
    struct scene *scene = scene_load("builtin:dragon:triangles=2000", &err);
    struct adjacency a;
    assert_non_null(scene);
    assert_true(adjacency_init(&a, scene, &err));
    size_t linked = 0;
    for (size_t m = 0; m < scene->mesh_count; m++)
        for (uint32_t t = 0; t < scene->meshes[m].index_count / 3; t++)
            for (int k = 0; k < 3; k++) {
                uint32_t other = adjacency_of(&a, &scene->meshes[m], t)[k];
                if (other == SCENE_NONE)
                    continue;
                const uint32_t *back = adjacency_of(&a, &scene->meshes[m], other);
                assert_true(back[0] == t || back[1] == t || back[2] == t);
                linked++;
            }
    assert_true(linked > 2000);
    adjacency_finish(&a);
    scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_positions_join),
        cmocka_unit_test(test_edges_of_three_join_none),
        cmocka_unit_test(test_repeated_corners_are_no_edges),
        cmocka_unit_test(test_links_are_mutual),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
