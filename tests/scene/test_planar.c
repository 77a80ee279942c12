/* Which meshes are planar, and on which side of them the rest lies. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "made_scene.h"

/* In y = 0, its normal upwards. */
static const float floor_points[6][3] = {{-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {-5, 0, -5}, {5, 0, 5}, {5, 0, -5}};

static void add_tetrahedron(struct scene *scene, uint32_t material, float height)
{
    const float a[3] = {0, height, 0}, b[3] = {1, height, 0}, c[3] = {0, height, 1}, top[3] = {0, height + 1, 0};
    float points[12][3];
    const float *const corners[12] = {a, b, c, a, b, top, b, c, top, c, a, top};
    for (int i = 0; i < 12; i++)
        for (int k = 0; k < 3; k++)
            points[i][k] = corners[i][k];
    made_triangles(scene, points, 12, material);
}

static int8_t side_of_floor(const float *heights, size_t count, bool turned)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, false);
    uint32_t indices[6] = {0, 1, 2, 3, 4, 5};
    uint32_t mesh = made_mesh(scene, floor_points, NULL, 6, indices, 6, material);
    struct affine to_world = affine_identity();
    if (turned)
        to_world.linear[1][1] = to_world.linear[2][2] = -1;
    made_instance(scene, mesh, to_world);
    for (size_t i = 0; i < count; i++)
        add_tetrahedron(scene, material, heights[i]);
    made_finish(scene);
    assert_true(scene->meshes[mesh].planar);
    for (size_t i = 0; i < count; i++) {
        assert_false(scene->meshes[1 + i].planar);
        assert_int_equal(scene->instances[1 + i].others_side, 0);
    }
    int8_t side = scene->instances[0].others_side;
    if (side != 0)
        assert_true(fabs(scene->instances[0].plane_normal.y - (turned ? -1 : 1)) < 1e-12);
    scene_destroy(scene);
    return side;
}

static void others_on_one_side(void **state)
{
    (void)state;
    const float above[] = {0, 2}, below[] = {-1, -3}, both[] = {1, -4}, through[] = {-0.5f}, dips[] = {-1e-7f};
    assert_int_equal(side_of_floor(above, 2, false), 1);
    assert_int_equal(side_of_floor(above, 2, true), -1);
    assert_int_equal(side_of_floor(below, 2, false), -1);
    assert_int_equal(side_of_floor(both, 2, false), 0);
    assert_int_equal(side_of_floor(through, 1, false), 0);
    assert_int_equal(side_of_floor(dips, 1, false), 1);
    assert_int_equal(side_of_floor(NULL, 0, false), 2);
}

/* A box that straddles a tilted plane although its geometry does not. */
static void judged_by_triangles_where_boxes_do_not_do(void **state)
{
    (void)state;
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, false);
    const float slope[3][3] = {{-9, -9, 0}, {9, 9, 0}, {0, 0, 9}};
    const float beside[6][3] = {{-4, -3.9f, 0}, {4, 4.1f, 0}, {4, 4.1f, 1}, {-4, -3.9f, 0}, {4, 4.1f, 1}, {0, 5, 0}};
    made_triangles(scene, slope, 3, material);
    made_triangles(scene, beside, 6, material);
    made_finish(scene);
    struct instance *i = &scene->instances[0];
    assert_true(scene->meshes[i->mesh].planar);
    assert_int_not_equal(i->others_side, 0);
    struct dvec3 p = instance_vertex(scene, &scene->instances[1], 1, 2);
    double height = dvec3_dot(dvec3_sub(p, i->plane_point), i->plane_normal);
    assert_true(height * i->others_side > 0);
    scene_destroy(scene);
}

static void no_area_is_no_plane(void **state)
{
    (void)state;
    struct scene *scene = made_scene();
    const float line[6][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {NAN, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    made_triangles(scene, line, 6, made_material(scene, false));
    made_finish(scene);
    assert_false(scene->meshes[0].planar);
    assert_int_equal(scene->instances[0].others_side, 0);
    scene_destroy(scene);
}

static void planar_to_a_millionth(void **state)
{
    (void)state;
    const float bent[2] = {4e-6f, 4e-5f};
    for (int i = 0; i < 2; i++) {
        struct scene *scene = made_scene();
        const float points[6][3] = {{0, 0, 0}, {10, 0, 0}, {0, 0, 10}, {10, 0, 0}, {0, 0, 10}, {9, bent[i], 9}};
        made_triangles(scene, points, 6, made_material(scene, false));
        made_finish(scene);
        assert_int_equal(scene->meshes[0].planar, i == 0);
        scene_destroy(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(others_on_one_side),
        cmocka_unit_test(judged_by_triangles_where_boxes_do_not_do),
        cmocka_unit_test(no_area_is_no_plane),
        cmocka_unit_test(planar_to_a_millionth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
