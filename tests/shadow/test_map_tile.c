/* The kernels that rasterize a geometry map's tiles (shadow/geometry/map_tile.h): the same bits whatever the instruction set, and every touched texel marked. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "base/lanes.h"
#include "made_scene.h"
#include "shadow/geometry/conservative.h"
#include "shadow/fit.h"
#include "shadow/geometry/map_tile.h"

#define SIZE 192

enum { CELLS = MAP_TILE * MAP_TILE };

struct made_map {
    struct scene *scene;
    struct geometry_map map;
    uint32_t *triangles; /* all that are not wild */
    size_t count;
};

static void list_triangles(struct made_map *made)
{
    const struct light_mesh *mesh = &made->map.mesh;
    made->triangles = malloc((mesh->triangle_count + 1) * sizeof *made->triangles);
    made->count = 0;
    for (size_t p = 0; p < mesh->part_count; p++)
        for (uint32_t i = 0; i < mesh->parts[p].triangle_count; i++) {
            uint32_t id = mesh->parts[p].first_triangle + i;
            struct light_triangle t = light_part_triangle(&mesh->parts[p], id);
            if (!light_triangle_wild(&t))
                made->triangles[made->count++] = id;
        }
}

static struct made_map make_map(const char *name, enum light_kind kind)
{
    struct error err = {0};
    struct made_map made = {.scene = scene_load(name, &err)};
    if (!made.scene)
        fail_msg("%s: %s", name, err.message);
    struct light light = made_light(kind, dvec3(2, 4, 1.5), dvec3(0, 0.4, 0));
    struct fit_geometry geometry;
    struct shadow_fit fit;
    uint32_t *casters = calloc(made.scene->instance_count + 1, sizeof *casters);
    struct job_pool *pool = job_pool_create(1, &err);
    assert_true(pool && fit_geometry_init(&geometry, made.scene, &err));
    shadow_fit_compute(&geometry, &light, SIZE, false, casters, &fit);
    assert_true(fit.map_count > 0);
    assert_true(geometry_map_build(&made.map, made.scene, &fit.maps[0], fit.casters, fit.caster_count, pool, &err));
    list_triangles(&made);
    fit_geometry_finish(&geometry);
    job_pool_destroy(pool);
    free(casters);
    return made;
}

static void finish_map(struct made_map *made)
{
    free(made->triangles);
    geometry_map_finish(&made->map);
    scene_destroy(made->scene);
}

/* Texels that hold something; fails where `kernel`, of whose triangles the first `front` are not tested for being hidden, says other than the
 * plain one that tests none. */
static size_t check_kernel(const struct made_map *made, map_tile_kernel *kernel, size_t front)
{
    static struct map_cell expected[CELLS], found[CELLS];
    size_t held = 0;
    for (uint32_t y = 0; y < made->map.tiles; y++)
        for (uint32_t x = 0; x < made->map.tiles; x++) {
            map_tile_plain(&made->map, x, y, made->triangles, made->count, made->count, expected);
            kernel(&made->map, x, y, made->triangles, front, made->count, found);
            assert_memory_equal(expected, found, sizeof found);
            for (size_t i = 0; i < CELLS; i++)
                held += found[i].triangle != MAP_NONE;
        }
    return held;
}

/* Those that this machine runs; returns how many. */
static size_t list_kernels(map_tile_kernel *kernels[3])
{
    size_t count = 0;
    kernels[count++] = map_tile_plain;
#ifdef __x86_64__
    if (map_tile_avx2 && __builtin_cpu_supports("avx2"))
        kernels[count++] = map_tile_avx2;
    if (map_tile_avx512 && __builtin_cpu_supports("avx512f"))
        kernels[count++] = map_tile_avx512;
#endif
    return count;
}

static void check_scene(const char *name, enum light_kind kind)
{
    struct made_map made = make_map(name, kind);
    map_tile_kernel *kernels[3];
    for (size_t k = list_kernels(kernels); k-- > 0;) {
        assert_true(check_kernel(&made, kernels[k], made.count) > 100);
        check_kernel(&made, kernels[k], 0);
        check_kernel(&made, kernels[k], made.count / 2);
    }
    finish_map(&made);
}

static void test_kernels_make_the_same_bits(void **state)
{
    (void)state;
    check_scene("builtin:dragon:triangles=2000", LIGHT_POINT);
    check_scene("builtin:ball", LIGHT_DIRECTIONAL);
    check_scene("builtin:hard-04-contact", LIGHT_SPOT);
    check_scene("builtin:hard-11-degenerate", LIGHT_POINT);
    check_scene("builtin:hard-03-sliver", LIGHT_DIRECTIONAL);
    check_scene("builtin:hard-19-cards", LIGHT_POINT);
}

/* Bits of the texels that `t`, alone, touches in rows of a tile. */
static void touch_tile(const struct light_triangle *t, uint32_t tile_x, uint32_t tile_y, uint32_t rows[MAP_TILE])
{
    float x[3], y[3];
    struct conservative over;
    memset(rows, 0, MAP_TILE * sizeof *rows);
    for (int k = 0; k < 3; k++) {
        x[k] = t->corner[k]->x - (float)(tile_x * MAP_TILE);
        y[k] = t->corner[k]->y - (float)(tile_y * MAP_TILE);
    }
    if (conservative_setup(&over, x, y, MAP_TILE, MAP_TILE))
        for (int32_t row = 0; row < (int32_t)MAP_TILE; row++)
            for (int32_t column = 0; column < (int32_t)MAP_TILE; column += LANES)
                rows[row] |= conservative_row(&over, column, row) << column;
}

/* Returns how many texels triangle `id` touches; fails where `kernel` marks other ones. */
static size_t check_triangle(const struct made_map *made, map_tile_kernel *kernel, uint32_t id)
{
    const struct geometry_map *m = &made->map;
    static struct map_cell cells[CELLS];
    uint32_t hint = 0, expected[MAP_TILE];
    const struct light_part *part = light_mesh_part(&m->mesh, id, &hint);
    struct light_triangle t = light_part_triangle(part, id);
    size_t count = 0;
    if (light_part_degenerate(m->mesh.scene, part, id))
        return 0;
    for (uint32_t y = 0; y < m->tiles; y++)
        for (uint32_t x = 0; x < m->tiles; x++) {
            touch_tile(&t, x, y, expected);
            kernel(m, x, y, &id, 1, 1, cells);
            for (size_t i = 0; i < CELLS; i++) {
                bool touched = expected[i / MAP_TILE] >> i % MAP_TILE & 1;
                assert_int_equal(touched, cells[i].triangle != MAP_NONE);
                count += touched;
            }
        }
    return count;
}

static void check_alone(const char *name, enum light_kind kind)
{
    struct made_map made = make_map(name, kind);
    map_tile_kernel *kernels[3];
    size_t step = made.count / 60 + 1;
    assert_true(made.map.wild_count == 0);
    for (size_t k = list_kernels(kernels); k-- > 0;) {
        size_t touched = 0;
        for (size_t i = 0; i < made.count; i += step)
            touched += check_triangle(&made, kernels[k], made.triangles[i]);
        assert_true(touched > 100);
    }
    finish_map(&made);
}

static void test_a_triangle_alone_marks_what_it_touches(void **state)
{
    (void)state;
    check_alone("builtin:ball", LIGHT_DIRECTIONAL);
    check_alone("builtin:hard-03-sliver", LIGHT_DIRECTIONAL);
    check_alone("builtin:hard-03-sliver", LIGHT_POINT);
    check_alone("builtin:hard-04-contact", LIGHT_SPOT);
    check_alone("builtin:butterfly", LIGHT_POINT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_kernels_make_the_same_bits),
                                       cmocka_unit_test(test_a_triangle_alone_marks_what_it_touches)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
