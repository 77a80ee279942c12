#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "made_scene.h"
#include "reference/oracle.h"
#include "trace/tracer.h"

/* A floor, and over it at y = 1 a plate of two squares, the left one (x < 0) twice as long as the right one. Light from above, a camera that
 * looks straight down between the two, a map of one texel. */
enum { SIDE = 32, N = SIDE * SIDE };

struct bench {
    struct scene *scene;
    struct job_pool *pool;
    struct tracer *tracer;
    struct view view, map;
    struct light light;
    uint32_t ids[N];
    uint8_t receiver[N];
    float visibility[N];
};

static void add_square(struct scene *scene, uint32_t material, float x0, float x1, float z, float y)
{
    const float points[6][3] = {{x0, y, -z}, {x1, y, -z}, {x1, y, z}, {x0, y, -z}, {x1, y, z}, {x0, y, z}};
    made_triangles(scene, points, 6, material);
}

static struct view from_above(double height, double half, uint32_t side)
{
    struct camera camera = made_camera(dvec3(0, height, 0), dvec3(0, 0, 0), 1);
    camera.orthographic = true;
    camera.ymag = half;
    camera.far = 20;
    return view_from_camera(&camera, side, side);
}

static struct bench *set_up(double map_half)
{
    struct error err = {0};
    struct bench *b = calloc(1, sizeof *b);
    b->scene = made_scene();
    uint32_t material = made_material(b->scene, true);
    add_square(b->scene, material, -4, 4, 4, 0);
    add_square(b->scene, material, -2, 0, 1, 1);
    add_square(b->scene, material, 0, 1, 1, 1);
    made_finish(b->scene);
    b->pool = job_pool_create(2, &err);
    b->tracer = tracer_create(b->scene, 2, &err);
    assert_non_null(b->tracer);
    b->view = from_above(0.5, 3, SIDE);
    b->map = from_above(5, map_half, 1);
    b->light = made_light(LIGHT_DIRECTIONAL, dvec3(0, 5, 0), dvec3(0, 0, 0));
    tracer_camera(b->tracer, &b->view, b->pool, b->ids, NULL);
    for (int i = 0; i < N; i++)
        b->receiver[i] = b->ids[i] < 2;
    return b;
}

static void strike(struct bench *b)
{
    tracer_destroy(b->tracer);
    job_pool_destroy(b->pool);
    scene_destroy(b->scene);
    free(b);
}

/* How many pixels are dark; each of them must lie under the plate between x0 and x1. */
static int dark(struct bench *b, unsigned length, double x0, double x1)
{
    static const uint32_t casters[] = {1, 2};
    const struct oracle_input in = {.maps = &b->map,
                                    .map_count = 1,
                                    .casters = casters,
                                    .caster_count = 2,
                                    .length = length,
                                    .view = &b->view,
                                    .light = &b->light,
                                    .ids = b->ids,
                                    .receiver = b->receiver};
    int count = 0;
    assert_true(oracle_visibility(b->scene, b->tracer, &in, b->pool, NULL, b->visibility));
    for (uint32_t i = 0; i < N; i++) {
        struct dvec3 p, direction;
        view_ray(&b->view, i % SIDE + 0.5, i / SIDE + 0.5, &p, &direction);
        assert_int_equal(b->receiver[i], 1);
        if (b->visibility[i] > 0)
            continue;
        count++;
        assert_true(p.x > x0 && p.x < x1 && fabs(p.z) < 1);
    }
    return count;
}

/* 5.33 pixels a unit: each triangle of the left square shadows half of 4 square units, of the right one half of 2. */
static void longer_lists_shadow_more(void **state)
{
    (void)state;
    struct bench *b = set_up(3);
    int one = dark(b, 1, -2, 0), two = dark(b, 2, -2, 0), three = dark(b, 3, -2, 1), four = dark(b, 4, -2, 1);
    assert_true(one > 40 && one < two && two < three && three < four);
    assert_true(abs(two - 2 * one) <= 12 && abs(2 * four - 3 * two) <= 24);
    assert_int_equal(dark(b, ORACLE_LENGTH_MAX, -2, 1), four);
    strike(b);
}

/* A texel that is wholly covered has no light behind it, listed or not; outside the map all is lit. */
static void covered_texels_are_dark_behind(void **state)
{
    (void)state;
    struct bench *b = set_up(0.9);
    int count = dark(b, 1, -2, 1);
    assert_true(abs(count - (int)(1.8 * 1.8 * SIDE * SIDE / 36)) <= 20);
    strike(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(longer_lists_shadow_more),
        cmocka_unit_test(covered_texels_are_dark_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
