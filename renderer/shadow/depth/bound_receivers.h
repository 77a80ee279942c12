/* Eight receivers against map_bounds.h. Included by the kernels only (depth_plain.c, depth_avx*.c). */
#pragma once

#include "shadow/depth/depth_receivers.h"
#include "shadow/depth/map_bounds.h"

/* What may be stored at each lane's own point, and how that changes by texel. */
struct receiver_bounds {
    lanes high, low, slope_x, slope_y;
};

/* Roundings of what is computed from bounds stay below this: depths are stored as at most 1. */
static const float BOUND_MARGIN = 4e-6f;

/* As far as `reach` <= BOUND_LARGEST texels around. */
LANES_INLINE struct receiver_bounds bounds_at(const struct depth_job *job, const struct map_points *m, lanes reach)
{
    const struct bound_level *level = job->bounds->levels;
    const float *first = (const float *)level[0].around;
    lane_ints blocks = lane_ints_all((int32_t)level[0].blocks), start = lane_ints_all(0);
    lanes side = lanes_all(BOUND_SIDE);
    for (int i = 1; i < BOUND_LEVELS; i++) {
        lane_ints wider = reach > (float)(BOUND_SIDE << (i - 1));
        if (!lanes_bits(wider))
            break;
        const float *around = (const float *)level[i].around;
        blocks = lane_ints_pick(wider, lane_ints_all((int32_t)level[i].blocks), blocks);
        start = lane_ints_pick(wider, lane_ints_all((int32_t)((around - first) / 4)), start);
        side = lanes_pick(wider, lanes_all((float)(BOUND_SIDE << i)), side);
    }
    lane_ints x = lanes_truncate(m->x / side), y = lanes_truncate(m->y / side);
    lanes b[4];
    lanes_gather_fours(first, start + (m->map * blocks + y) * blocks + x, b);
    lanes at = b[0] * (m->x - (lanes_from(x) + 0.5f) * side) + b[1] * (m->y - (lanes_from(y) + 0.5f) * side);
    return (struct receiver_bounds){b[2] + at, b[3] + at, b[0], b[1]};
}
