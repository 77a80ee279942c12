/* Planes between which a light's depth maps lie, block by block: one look tells for most receivers that nothing round them stands before them,
 * or everything, before many texels are read. On surfaces that slope, ranges of depths cannot.
 *
 * Kernels (bound_lanes.h) make them from blocks of 8 x 8 texels upwards: slopes from differences of depth, then the least and largest distance
 * of any texel from that plane. Both depth encodings are affine over a plane's picture (shaders/maps.glsl). */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct job_pool;
struct error;

enum { BOUND_SIDE = 8, BOUND_LEVELS = 4, BOUND_LARGEST = BOUND_SIDE << (BOUND_LEVELS - 1) };

/* What a texel whose centre lies (x, y) texels from that of its block stores is from slope_x x + slope_y y + low to the same with high. */
struct map_bound {
    float slope_x, slope_y, high, low;
};

/* Blocks of BOUND_SIDE << level texels a side, map after map. */
struct bound_level {
    uint32_t blocks;          /* a side of a map */
    struct map_bound *around; /* of a block and its eight neighbours; infinite where those are not all within the map */
    struct map_bound *own;    /* of the block; of whole ones only */
    float *own_nearest;       /* the largest value that the block stores */
};

struct map_bounds {
    struct bound_level levels[BOUND_LEVELS];
    float *nearest; /* of a block of level `nearest_level` and its eight neighbours */
    unsigned nearest_level;
    void *room; /* of all; owned */
    size_t bytes;
};

/* From `maps` maps of `side` x `side` texels. */
bool map_bounds_prepare(struct map_bounds *b, const float *texels, uint32_t side, unsigned maps, unsigned nearest_level,
                        struct job_pool *pool, struct error *err);
void map_bounds_finish(struct map_bounds *b);

/* A band of BOUND_LARGEST rows of one map at work, for kernels. */
struct bound_job {
    const struct map_bounds *bounds;
    const float *texels;
    uint32_t side, bands; /* bands a map */
};
