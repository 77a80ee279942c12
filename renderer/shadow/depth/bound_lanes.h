/* map_bounds.h's planes from texels. Included by the kernels only (depth_plain.c, depth_avx*.c). */
#pragma once

#include <math.h>

#include "base/lanes.h"
#include "shadow/depth/map_bounds.h"

/* Of 8 x 8 texels from `row` on. */
LANES_INLINE struct map_bound bound_of_texels(const float *row, size_t side, float *nearest)
{
    const float *last = row + 7 * side, *middle = row + 3 * side;
    float x = (middle[7] - middle[0] + (middle[side + 7] - middle[side])) * (1.0f / 14);
    float y = (last[3] - row[3] + (last[4] - row[4])) * (1.0f / 14);
    lanes slant = x * (lanes){-3.5f, -2.5f, -1.5f, -0.5f, 0.5f, 1.5f, 2.5f, 3.5f} - 3.5f * y;
    lanes high = lanes_all(-INFINITY), low = lanes_all(INFINITY), most = lanes_all(0);
    for (int i = 0; i < 8; i++, row += side, slant += y) {
        lanes stored = lanes_load(row), off = stored - slant;
        high = lanes_max(high, off);
        low = lanes_min(low, off);
        most = lanes_max(most, stored);
    }
    *nearest = lanes_largest(most);
    return (struct map_bound){x, y, lanes_largest(high), lanes_least(low)};
}

static float nearest_of_part(const float *texels, size_t side, size_t x, size_t y)
{
    float most = 0;
    for (size_t j = y; j < side && j < y + 8; j++)
        for (size_t i = x; i < side && i < x + 8; i++)
            most = texels[j * side + i] > most ? texels[j * side + i] : most;
    return most;
}

/* Widens `b` so that it holds for a block `half` texels to either side too, which lies (x, y) away and has `other`. */
LANES_INLINE void bound_take_in(struct map_bound *b, const struct map_bound *other, float x, float y, float half)
{
    float dx = other->slope_x - b->slope_x, dy = other->slope_y - b->slope_y, along = b->slope_x * x + b->slope_y * y;
    float spread = half * (fabsf(dx) + fabsf(dy)), high = other->high - along + spread, low = other->low - along - spread;
    b->high = high > b->high ? high : b->high;
    b->low = low < b->low ? low : b->low;
}

/* Of 2 x 2 blocks of `side` texels, rows of them `blocks` long. */
LANES_INLINE struct map_bound bound_of_four(const struct map_bound *from, size_t blocks, float side)
{
    const struct map_bound *f[4] = {from, from + 1, from + blocks, from + blocks + 1};
    float middle[4];
    for (int i = 0; i < 4; i++)
        middle[i] = 0.5f * (f[i]->high + f[i]->low);
    struct map_bound b = {(middle[1] - middle[0] + (middle[3] - middle[2])) / (2 * side),
                          (middle[2] - middle[0] + (middle[3] - middle[1])) / (2 * side), -INFINITY, INFINITY};
    for (int i = 0; i < 4; i++)
        bound_take_in(&b, f[i], i % 2 ? side / 2 : -side / 2, i / 2 ? side / 2 : -side / 2, side / 2);
    return b;
}

static void bound_texel_row(const struct bound_job *job, const struct bound_level *level, unsigned map, uint32_t y)
{
    const float *texels = job->texels + (size_t)map * job->side * job->side;
    size_t at = ((size_t)map * level->blocks + y) * level->blocks;
    bool whole_row = (y + 1) * BOUND_SIDE <= job->side;
    for (uint32_t x = 0; x < level->blocks; x++, at++)
        if (whole_row && (x + 1) * BOUND_SIDE <= job->side)
            level->own[at] = bound_of_texels(texels + (size_t)y * BOUND_SIDE * job->side + (size_t)x * BOUND_SIDE, job->side,
                                             &level->own_nearest[at]);
        else
            level->own_nearest[at] = nearest_of_part(texels, job->side, (size_t)x * BOUND_SIDE, (size_t)y * BOUND_SIDE);
}

/* From the level before. */
static void bound_block_row(const struct bound_job *job, const struct bound_level *level, float side, unsigned map, uint32_t y)
{
    const struct bound_level *finer = level - 1;
    uint32_t whole = job->side / (2 * (uint32_t)side);
    const size_t blocks = finer->blocks, from = ((size_t)map * blocks + 2 * y) * blocks, down = 2 * y + 1 < blocks ? blocks : 0;
    size_t at = ((size_t)map * level->blocks + y) * level->blocks;
    for (uint32_t x = 0; x < level->blocks; x++, at++) {
        const float *n = finer->own_nearest + from + 2 * x;
        size_t right = 2 * x + 1 < blocks ? 1 : 0;
        level->own_nearest[at] = larger(larger(n[0], n[right]), larger(n[down], n[down + right]));
        if (x < whole && y < whole)
            level->own[at] = bound_of_four(finer->own + from + 2 * x, blocks, side);
    }
}

/* Blocks of a level whose rows of blocks start in a band. */
LANES_INLINE uint32_t band_first(uint32_t band, unsigned level) { return band << (BOUND_LEVELS - 1 - level); }
LANES_INLINE uint32_t band_end(uint32_t band, const struct bound_level *l, unsigned level)
{
    uint32_t end = band_first(band + 1, level);
    return end < l->blocks ? end : l->blocks;
}

static void bound_band(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct bound_job *job = context;
    unsigned map = (unsigned)(index / job->bands);
    uint32_t band = (uint32_t)(index % job->bands);
    for (unsigned i = 0; i < BOUND_LEVELS; i++) {
        const struct bound_level *level = &job->bounds->levels[i];
        for (uint32_t y = band_first(band, i), end = band_end(band, level, i); y < end; y++)
            if (i == 0)
                bound_texel_row(job, level, map, y);
            else
                bound_block_row(job, level, (float)(BOUND_SIDE << (i - 1)), map, y);
    }
}

static void bound_widen_row(const struct bound_job *job, const struct bound_level *level, uint32_t side, unsigned map, uint32_t y)
{
    const uint32_t whole = job->side / side;
    const struct map_bound nothing = {0, 0, INFINITY, -INFINITY};
    size_t blocks = level->blocks, at = ((size_t)map * blocks + y) * blocks;
    for (uint32_t x = 0; x < blocks; x++, at++) {
        struct map_bound b = nothing;
        if (x > 0 && y > 0 && x + 1 < whole && y + 1 < whole) {
            b = level->own[at];
            for (int i = -1; i < 2; i++)
                for (int j = -1; j < 2; j++)
                    bound_take_in(&b, &level->own[at + (size_t)i * blocks + (size_t)j], (float)(j * (int)side),
                                  (float)(i * (int)side), (float)side / 2);
        }
        level->around[at] = b;
    }
}

static void nearest_row(const struct map_bounds *bounds, const struct bound_level *level, unsigned map, uint32_t y)
{
    int32_t last = (int32_t)level->blocks - 1, row = (int32_t)y;
    const float *own = level->own_nearest + (size_t)map * level->blocks * level->blocks;
    float *out = bounds->nearest + ((size_t)map * level->blocks + y) * level->blocks;
    for (int32_t x = 0; x <= last; x++) {
        float most = 0;
        for (int32_t j = row > 0 ? row - 1 : 0; j <= (row < last ? row + 1 : last); j++)
            for (int32_t i = x > 0 ? x - 1 : 0; i <= (x < last ? x + 1 : last); i++)
                most = larger(most, own[(size_t)j * level->blocks + (size_t)i]);
        out[x] = most;
    }
}

/* After all bands. */
static void bound_widen_band(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct bound_job *job = context;
    unsigned map = (unsigned)(index / job->bands);
    uint32_t band = (uint32_t)(index % job->bands);
    for (unsigned i = 0; i < BOUND_LEVELS; i++) {
        const struct bound_level *level = &job->bounds->levels[i];
        for (uint32_t y = band_first(band, i), end = band_end(band, level, i); y < end; y++) {
            bound_widen_row(job, level, BOUND_SIDE << i, map, y);
            if (i == job->bounds->nearest_level)
                nearest_row(job->bounds, level, map, y);
        }
    }
}
