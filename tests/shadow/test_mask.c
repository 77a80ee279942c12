/* The parts of `mask`: its table against the samples, its contour map against every edge and every face. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "made_scene.h"
#include "scene/view.h"
#include "shadow/geometry/conservative.h"
#include "shadow/fit.h"
#include "shadow/mask/mask_contour.h"
#include "shadow/mask/mask_table.h"

static struct mask_table table;

static uint32_t true_mask(double c, double x, double y)
{
    uint32_t mask = 0;
    for (int i = 0; i < 32; i++)
        mask |= (uint32_t)(c + x * ((double)view_samples32[i][0] - 0.5) + y * ((double)view_samples32[i][1] - 0.5) > 0) << i;
    return mask;
}

static double unit(unsigned *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) * (1.0 / 16777216);
}

static void test_table_is_nearly_the_samples(void **state)
{
    (void)state;
    unsigned seed = 1;
    double wrong = 0, bits = 0;
    mask_table_fill(&table);
    for (int i = 0; i < 20000; i++) {
        double turn = 6.283185307179586 * unit(&seed), x = cos(turn), y = sin(turn);
        double c = (unit(&seed) - 0.5) * (fabs(x) + fabs(y)), scale = exp(20 * unit(&seed) - 10);
        uint32_t looked = mask_table_look(&table, (float)(c * scale), (float)(x * scale), (float)(y * scale));
        wrong += __builtin_popcount(looked ^ true_mask(c, x, y));
        bits += 32;
    }
    print_message("%.4f %% of the bits wrong, %.4f %% told\n", 100 * wrong / bits, 100 * table.wrong);
    assert_true(wrong > 0 && wrong / bits < 0.004);
    assert_true(table.wrong > 0.5 * wrong / bits && table.wrong < 2 * wrong / bits);
}

static void test_table_off_the_pixel(void **state)
{
    (void)state;
    assert_int_equal(mask_table_look(&table, 1, 0.5f, 0.5f), UINT32_MAX);
    assert_int_equal(mask_table_look(&table, -1, 0.5f, 0.5f), 0);
    assert_int_equal(mask_table_look(&table, 0.6f, 1, 0), UINT32_MAX);
    assert_int_equal(mask_table_look(&table, 0, 0, 0), 0);
    assert_int_equal(mask_table_look(&table, NAN, 1, 1), 0);
    assert_int_equal(mask_table_look(&table, 1, 0, 0), UINT32_MAX);
    /* Upright and level lines through the middle: sixteen samples each side. */
    assert_int_equal(__builtin_popcount(mask_table_look(&table, 0, 1, 0)), 16);
    assert_int_equal(__builtin_popcount(mask_table_look(&table, 0, 0, -1)), 16);
    assert_int_equal(mask_table_look(&table, 0.1f, -0.3f, 0.9f) & mask_table_look(&table, -0.1f, 0.3f, -0.9f), 0);
}

/* A map of a scene in the light of a point above it. */
struct made {
    struct scene *scene;
    struct adjacency adjacency;
    struct mask_contour map;
    struct job_pool *pool;
};

static const enum light_kind kinds[] = {LIGHT_POINT, LIGHT_DIRECTIONAL};

static void build(struct made *m, enum light_kind kind, unsigned threads)
{
    struct error err = {0};
    struct fit_geometry fit;
    struct shadow_fit maps;
    struct light light = made_light(kind, dvec3(0.5, 5, 0.75), dvec3(0, 0, 0));
    uint32_t *casters = calloc(m->scene->instance_count, sizeof *casters);
    m->pool = job_pool_create(threads, &err);
    assert_true(casters && m->pool && fit_geometry_init(&fit, m->scene, &err));
    shadow_fit_compute(&fit, &light, 128, false, casters, &maps);
    assert_int_equal(maps.map_count, 1);
    m->map = (struct mask_contour){0};
    assert_true(adjacency_init(&m->adjacency, m->scene, &err));
    assert_true(
        mask_contour_build(&m->map, m->scene, &m->adjacency, &maps.maps[0], maps.casters, maps.caster_count, 0, m->pool, &err));
    fit_geometry_finish(&fit);
    free(casters);
}

static void drop(struct made *m)
{
    mask_contour_finish(&m->map);
    adjacency_finish(&m->adjacency);
    job_pool_destroy(m->pool);
}

static struct scene *load(const char *name)
{
    struct error err = {0};
    struct scene *scene = scene_load(name, &err);
    if (!scene)
        fail_msg("%s", err.message);
    return scene;
}

/* Every crossed texel lists exactly the faces that touch it. */
static void check_lists(const struct mask_contour *m)
{
    size_t texels = 0, entries = 0;
    for (uint32_t y = 0; y < m->size; y++)
        for (uint32_t x = 0; x < m->size; x++) {
            if (!mask_contour_at(m, x, y))
                continue;
            uint32_t list = mask_contour_index(m, x, y), next = m->first[list];
            texels++;
            for (size_t p = 0; p < m->mesh.part_count; p++)
                for (uint32_t t = 0; t < m->mesh.parts[p].triangle_count; t++) {
                    uint32_t id = m->mesh.parts[p].first_triangle + t;
                    struct light_triangle c = light_part_triangle(&m->mesh.parts[p], id);
                    const float px[3] = {c.corner[0]->x, c.corner[1]->x, c.corner[2]->x};
                    const float py[3] = {c.corner[0]->y, c.corner[1]->y, c.corner[2]->y};
                    assert_false(light_triangle_wild(&c));
                    if (!conservative_touches(px, py, (float)x, (float)y))
                        continue;
                    assert_true(next < m->first[list + 1]);
                    assert_int_equal(m->faces[m->entries[next++].face].id, id);
                }
            assert_int_equal(next, m->first[list + 1]);
            entries += next - m->first[list];
        }
    assert_int_equal(texels, m->crossed_count);
    assert_int_equal(entries, m->entry_count);
    assert_true(texels > 50 && entries > texels);
}

static void test_lists_hold_every_face(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct made m = {.scene = load("builtin:box")};
        build(&m, kinds[k], 2);
        check_lists(&m.map);
        drop(&m);
        scene_destroy(m.scene);
    }
}

/* Along every silhouette edge that lies on the map, every texel is crossed; and most of the map is not. */
static void check_crossed(const struct made *made)
{
    const struct mask_contour *m = &made->map;
    size_t points = 0;
    for (size_t p = 0; p < m->mesh.part_count; p++) {
        const struct light_part *part = &m->mesh.parts[p];
        const struct mesh *mesh = &made->scene->meshes[made->scene->instances[part->instance].mesh];
        for (uint32_t t = 0; t < part->triangle_count; t++)
            for (unsigned k = 0; k < 3; k++) {
                uint32_t beyond = adjacency_of(&made->adjacency, mesh, t)[k];
                double area = light_triangle_sides(&m->mesh, part, part->first_triangle + t, 0, 0).area;
                double other =
                    beyond == SCENE_NONE ? 0 : light_triangle_sides(&m->mesh, part, part->first_triangle + beyond, 0, 0).area;
                if (area * other > 0)
                    continue;
                struct light_triangle c = light_part_triangle(part, part->first_triangle + t);
                const struct light_vertex *a = c.corner[k], *b = c.corner[(k + 1) % 3];
                for (int i = 0; i <= 200; i++) {
                    double x = a->x + (double)(b->x - a->x) * i / 200, y = a->y + (double)(b->y - a->y) * i / 200;
                    if (!(x >= 0 && y >= 0 && x < m->size && y < m->size))
                        continue;
                    points++;
                    assert_true(mask_contour_at(m, (uint32_t)x, (uint32_t)y));
                }
            }
    }
    assert_true(points > 1000);
    assert_true(m->crossed_count < (size_t)m->size * m->size / 2);
}

static void test_silhouettes_are_crossed(void **state)
{
    (void)state;
    static const char *const names[] = {"builtin:box", "builtin:hard-20-twosided", "builtin:hard-06-fan"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct made m = {.scene = load(names[i])};
        build(&m, LIGHT_POINT, 2);
        check_crossed(&m);
        drop(&m);
        scene_destroy(m.scene);
    }
}

/* A sheet inside its own border is whole: a quad of many triangles has its outline as its contour, and nothing within. */
static void test_inside_of_a_sheet_is_not_contour(void **state)
{
    (void)state;
    enum { N = 8 };
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true);
    const float floor[6][3] = {{-9, -1, -9}, {-9, -1, 9}, {9, -1, 9}, {-9, -1, -9}, {9, -1, 9}, {9, -1, -9}};
    static float points[6 * N * N][3];
    for (int i = 0; i < N * N; i++)
        for (int k = 0; k < 6; k++) {
            static const int corner[6][2] = {{0, 0}, {0, 1}, {1, 1}, {0, 0}, {1, 1}, {1, 0}};
            points[6 * i + k][0] = 2.0f * (float)(i % N + corner[k][0]) / N - 1;
            points[6 * i + k][2] = 2.0f * (float)(i / N + corner[k][1]) / N - 1;
        }
    made_triangles(scene, floor, 6, material);
    made_triangles(scene, (const float(*)[3])points, 6 * N * N, material);
    made_finish(scene);
    struct made m = {.scene = scene};
    build(&m, LIGHT_POINT, 1);
    assert_true(m.map.crossed_count >= 4 * 100 && m.map.crossed_count < 4 * 128 * 3);
    for (uint32_t y = 40; y < 88; y++)
        for (uint32_t x = 40; x < 88; x++)
            assert_false(mask_contour_at(&m.map, x, y));
    drop(&m);
    scene_destroy(scene);
}

/* Threads decide nothing. */
static void test_same_bits_with_any_pool(void **state)
{
    (void)state;
    struct scene *scene = load("builtin:dragon:triangles=20000");
    struct made one = {.scene = scene}, four = {.scene = scene};
    build(&one, LIGHT_POINT, 1);
    build(&four, LIGHT_POINT, 4);
    const struct mask_contour *a = &one.map, *b = &four.map;
    assert_int_equal(a->entry_count, b->entry_count);
    assert_memory_equal(a->crossed, b->crossed, (size_t)a->words * a->size * sizeof *a->crossed);
    assert_memory_equal(a->first, b->first, (a->crossed_count + 1) * sizeof *a->first);
    assert_memory_equal(a->entries, b->entries, a->entry_count * sizeof *a->entries);
    drop(&one);
    drop(&four);
    scene_destroy(scene);
}

static void test_limit_is_told(void **state)
{
    (void)state;
    struct error err = {0};
    struct made m = {.scene = load("builtin:box")};
    build(&m, LIGHT_POINT, 1);
    struct view view = m.map.mesh.view;
    const uint32_t caster = m.map.mesh.parts[0].instance;
    assert_false(mask_contour_build(&m.map, m.scene, &m.adjacency, &view, &caster, 1, 1000, m.pool, &err));
    assert_int_equal(err.code, ERROR_TRY_AGAIN);
    assert_non_null(strstr(err.message, "MiB"));
    drop(&m);
    scene_destroy(m.scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table_is_nearly_the_samples),
        cmocka_unit_test(test_table_off_the_pixel),
        cmocka_unit_test(test_lists_hold_every_face),
        cmocka_unit_test(test_silhouettes_are_crossed),
        cmocka_unit_test(test_inside_of_a_sheet_is_not_contour),
        cmocka_unit_test(test_same_bits_with_any_pool),
        cmocka_unit_test(test_limit_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
