/* Planes that bound depth maps: every texel lies between them, on every instruction set to the same bits. */
#include <math.h>
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
#include "shadow/depth/depth_pass.h"
#include "shadow/depth/map_bounds.h"

enum { MAPS = 2 };
static const double margin = 1e-6;

static double noise(uint32_t *seed)
{
    *seed = *seed * 1664525 + 1013904223;
    return (double)(*seed >> 8) / (1 << 24);
}

/* Slopes, a step, noise and nothing at all; malloc'd, with room for a vector past the end. */
static float *make_maps(uint32_t side)
{
    uint32_t seed = side;
    float *texels = calloc((size_t)MAPS * side * side + 8, sizeof *texels);
    assert_non_null(texels);
    for (uint32_t m = 0; m < MAPS; m++)
        for (uint32_t y = 0; y < side; y++)
            for (uint32_t x = 0; x < side; x++) {
                double v = 0.3 + 0.3 * x / side - 0.2 * y / side + (x > side / 2 && m ? 0.1 : 0);
                if (x < side / 4)
                    v = y < side / 4 ? 0 : noise(&seed);
                texels[(m * side + y) * side + x] = (float)v;
            }
    return texels;
}

/* How many texels lie beyond the bounds of what they are in. */
static size_t count_beyond(const struct map_bounds *b, const float *texels, uint32_t side)
{
    size_t beyond = 0;
    for (unsigned l = 0; l < BOUND_LEVELS; l++) {
        const struct bound_level *level = &b->levels[l];
        int32_t block = BOUND_SIDE << l, blocks = (int32_t)level->blocks;
        for (int32_t i = 0; i < MAPS * blocks * blocks; i++) {
            const struct map_bound *p = &level->around[i];
            int32_t bx = i % blocks * block, by = i / blocks % blocks * block, m = i / (blocks * blocks);
            if (isinf(p->high))
                continue;
            for (int32_t y = by - block; y < by + 2 * block; y++)
                for (int32_t x = bx - block; x < bx + 2 * block; x++) {
                    assert_true(x >= 0 && y >= 0 && x < (int32_t)side && y < (int32_t)side);
                    double at = p->slope_x * (x + 0.5 - (bx + 0.5 * block)) + p->slope_y * (y + 0.5 - (by + 0.5 * block));
                    double off = texels[((uint32_t)m * side + (uint32_t)y) * side + (uint32_t)x] - at;
                    beyond += off > p->high + margin || off < p->low - margin;
                }
        }
    }
    return beyond;
}

static void test_all_lie_between(void **state)
{
    (void)state;
    static const uint32_t sides[] = {16, 100, 256, 321};
    struct error err = {0};
    struct job_pool *pool = job_pool_create(2, &err);
    struct map_bounds b = {0};
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        float *texels = make_maps(sides[i]);
        assert_true(map_bounds_prepare(&b, texels, sides[i], MAPS, 2, pool, &err));
        assert_int_equal(count_beyond(&b, texels, sides[i]), 0);
        free(texels);
    }
    /* A slope is bounded tightly; a texel that sticks out is seen. */
    float *texels = make_maps(256);
    assert_true(map_bounds_prepare(&b, texels, 256, MAPS, 2, pool, &err));
    const struct map_bound *inner = &b.levels[0].around[10 * b.levels[0].blocks + 20];
    assert_true(inner->high - inner->low < 1e-5f);
    texels[200 * 256 + 200] += 0.01f;
    assert_true(count_beyond(&b, texels, 256) > 0);
    free(texels);
    map_bounds_finish(&b);
    job_pool_destroy(pool);
}

static void test_nearest(void **state)
{
    (void)state;
    enum { SIDE = 100, LEVEL = 1, BLOCK = BOUND_SIDE << LEVEL };
    struct error err = {0};
    struct job_pool *pool = job_pool_create(1, &err);
    struct map_bounds b = {0};
    float *texels = make_maps(SIDE);
    assert_true(map_bounds_prepare(&b, texels, SIDE, MAPS, LEVEL, pool, &err));
    int32_t blocks = (int32_t)b.levels[LEVEL].blocks;
    for (int32_t i = 0; i < MAPS * blocks * blocks; i++) {
        int32_t bx = i % blocks * BLOCK, by = i / blocks % blocks * BLOCK;
        float most = 0;
        for (int32_t y = by - BLOCK; y < by + 2 * BLOCK; y++)
            for (int32_t x = bx - BLOCK; x < bx + 2 * BLOCK; x++)
                if (x >= 0 && y >= 0 && x < SIDE && y < SIDE)
                    most = fmaxf(most, texels[(i / (blocks * blocks) * SIDE + y) * SIDE + x]);
        assert_true(b.nearest[i] == most);
    }
    free(texels);
    map_bounds_finish(&b);
    job_pool_destroy(pool);
}

static void test_same_bits(void **state)
{
    (void)state;
    const struct depth_kernel *best = depth_kernel_choose();
    if (best == &depth_plain)
        skip();
    struct error err = {0};
    struct job_pool *pool = job_pool_create(1, &err);
    struct map_bounds b = {0};
    float *texels = make_maps(321);
    assert_true(map_bounds_prepare(&b, texels, 321, MAPS, 3, pool, &err));
    struct bound_job job = {&b, texels, 321, b.levels[BOUND_LEVELS - 1].blocks};
    const struct bound_level *level = &b.levels[0];
    size_t size = (size_t)MAPS * level->blocks * level->blocks * sizeof *level->around;
    struct map_bound *wide = malloc(size);
    assert_non_null(wide);
    memcpy(wide, level->around, size);
    memset(level->around, 0, size);
    job_pool_for(pool, (size_t)MAPS * job.bands, depth_plain.bound, &job);
    job_pool_for(pool, (size_t)MAPS * job.bands, depth_plain.bound_widen, &job);
    assert_memory_equal(wide, level->around, size);
    free(wide);
    free(texels);
    map_bounds_finish(&b);
    job_pool_destroy(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_lie_between),
        cmocka_unit_test(test_nearest),
        cmocka_unit_test(test_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
