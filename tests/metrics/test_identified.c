#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "made_scene.h"
#include "reference/identified.h"
#include "trace/tracer.h"

/* A map of SIZE x SIZE texels, looked at along -z. Column by column (modulo 4): a square of two triangles in each texel; three slabs of two;
 * one triangle that is larger than the texel; nothing. */
enum { SIZE = 8, KINDS = 4 };
static const unsigned seen_in[KINDS] = {2, 6, 1, 0};

struct bench {
    struct scene *scene;
    struct job_pool *pool;
    struct tracer *tracer;
    struct view map;
    uint32_t first[SIZE * SIZE + 1], triangles[SIZE * SIZE * 8];
};

static void add_square(struct scene *scene, uint32_t material, float x0, float x1, float y0, float y1, uint32_t *count)
{
    const float points[6][3] = {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
    made_triangles(scene, points, 6, material);
    *count += 2;
}

static uint32_t add_texel(struct scene *scene, uint32_t material, uint32_t column, float y)
{
    float x = (float)column;
    uint32_t count = 0;
    if (column % KINDS == 0)
        add_square(scene, material, x, x + 1, y, y + 1, &count);
    for (int i = 0; column % KINDS == 1 && i < 3; i++)
        add_square(scene, material, x, x + 1, y + (float)i / 3, y + (float)(i + 1) / 3, &count);
    if (column % KINDS == 2) {
        const float one[3][3] = {{x, y, 0}, {x + 1, y, 0}, {x + 0.5f, y + 0.5f, 0}};
        made_triangles(scene, one, 3, material);
        count++;
    }
    return count;
}

static struct bench *set_up(void)
{
    struct error err = {0};
    struct bench *b = calloc(1, sizeof *b);
    b->scene = made_scene();
    uint32_t material = made_material(b->scene, true), id = 0, entries = 0;
    for (uint32_t t = 0; t < SIZE * SIZE; t++) {
        /* Row 0 is the top. */
        uint32_t count = add_texel(b->scene, material, t % SIZE, (float)(SIZE - 1 - t / SIZE));
        b->first[t] = entries;
        for (uint32_t i = 0; i < count; i++)
            b->triangles[entries++] = id + i;
        id += count;
    }
    b->first[SIZE * SIZE] = entries;
    made_finish(b->scene);
    b->pool = job_pool_create(2, &err);
    b->tracer = tracer_create(b->scene, 2, &err);
    assert_non_null(b->tracer);
    struct camera camera = made_camera(dvec3(SIZE / 2.0, SIZE / 2.0, 5), dvec3(SIZE / 2.0, SIZE / 2.0, 0), 1);
    camera.orthographic = true;
    camera.ymag = SIZE / 2.0;
    camera.far = 10;
    b->map = view_from_camera(&camera, SIZE, SIZE);
    return b;
}

static void strike(struct bench *b)
{
    tracer_destroy(b->tracer);
    job_pool_destroy(b->pool);
    scene_destroy(b->scene);
    free(b);
}

static struct identified measured(const struct bench *b)
{
    const struct identified_input in = {
        .maps = &b->map, .map_count = 1, .size = SIZE, .first = b->first, .triangles = b->triangles};
    struct identified out;
    assert_true(identified_measure(b->tracer, &in, b->pool, NULL, &out));
    return out;
}

/* Keeps the first `most` of each list. */
static void shorten(struct bench *b, uint32_t most)
{
    uint32_t entries = 0, from = 0;
    for (uint32_t t = 0; t < SIZE * SIZE; t++) {
        uint32_t end = b->first[t + 1], count = end - from < most ? end - from : most;
        b->first[t] = entries;
        memmove(b->triangles + entries, b->triangles + from, count * sizeof *b->triangles);
        entries += count;
        from = end;
    }
    b->first[SIZE * SIZE] = entries;
}

static bool near(double a, double b) { return fabs(a - b) < 1e-12; }

static void whole_lists_hold_all(void **state)
{
    (void)state;
    struct bench *b = set_up();
    struct identified m = measured(b);
    assert_int_equal(m.texels, SIZE * SIZE / 2); /* one triangle, or none, does not count */
    assert_int_equal(m.texels_over_4, SIZE * SIZE / 4);
    assert_int_equal(m.seen, SIZE * SIZE / 4 * (seen_in[0] + seen_in[1]));
    assert_int_equal(m.found, m.seen);
    assert_true(near(m.fractions, (double)m.texels));
    assert_int_equal(m.found_by_oracle, SIZE * SIZE / 4 * (2 + 5));
    assert_true(near(m.oracle_fractions, SIZE * SIZE / 4 * (1 + 5.0 / 6)));
    strike(b);
}

static void short_lists_hold_their_share(void **state)
{
    (void)state;
    struct bench *b = set_up();
    shorten(b, 4);
    struct identified m = measured(b);
    assert_int_equal(m.found, SIZE * SIZE / 4 * (2 + 4));
    shorten(b, 1);
    m = measured(b);
    assert_int_equal(m.found, SIZE * SIZE / 2);
    assert_true(near(m.fractions / (double)m.texels, (1.0 / 2 + 1.0 / 6) / 2));
    assert_true(near((double)m.found / (double)m.seen, 2.0 / 8));
    shorten(b, 0);
    m = measured(b);
    assert_true(m.texels == SIZE * SIZE / 2 && m.found == 0 && m.fractions == 0);
    strike(b);
}

/* Lists of the wrong texels: the comparison can fail. Rows that are upside down are such lists. */
static void lists_of_other_texels_hold_nothing(void **state)
{
    (void)state;
    struct bench *b = set_up();
    uint32_t per_row = b->first[SIZE], *copy = malloc(sizeof b->triangles);
    memcpy(copy, b->triangles, sizeof b->triangles);
    for (uint32_t row = 0; row < SIZE; row++)
        memcpy(b->triangles + row * per_row, copy + (SIZE - 1 - row) * per_row, per_row * sizeof *copy);
    struct identified m = measured(b);
    assert_true(m.texels == SIZE * SIZE / 2 && m.found == 0);
    free(copy);
    strike(b);
}

static void only_casters_are_seen(void **state)
{
    (void)state;
    struct bench *b = set_up();
    const uint32_t casters[] = {0};
    const struct identified_input in = {.maps = &b->map,
                                        .map_count = 1,
                                        .size = SIZE,
                                        .first = b->first,
                                        .triangles = b->triangles,
                                        .casters = casters,
                                        .caster_count = 1};
    struct identified m, twice = {0};
    assert_true(identified_measure(b->tracer, &in, b->pool, NULL, &m));
    assert_true(m.texels == 1 && m.seen == 2 && m.found == 2);
    identified_add(&twice, &m);
    identified_add(&twice, &m);
    assert_true(twice.texels == 2 && twice.seen == 4 && twice.found == 4 && near(twice.fractions, 2));
    const struct identified_input none = {.size = SIZE, .first = b->first, .triangles = b->triangles};
    assert_true(identified_measure(b->tracer, &none, b->pool, NULL, &m));
    assert_int_equal(m.texels, 0);
    strike(b);
}

/* The same texels from one thread as from two. */
static void draws_repeat(void **state)
{
    (void)state;
    struct error err = {0};
    struct bench *b = set_up();
    shorten(b, 3);
    struct identified two = measured(b);
    job_pool_destroy(b->pool);
    b->pool = job_pool_create(1, &err);
    struct identified one = measured(b);
    assert_memory_equal(&one, &two, sizeof one);
    strike(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_lists_hold_all),
        cmocka_unit_test(short_lists_hold_their_share),
        cmocka_unit_test(lists_of_other_texels_hold_nothing),
        cmocka_unit_test(only_casters_are_seen),
        cmocka_unit_test(draws_repeat),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
