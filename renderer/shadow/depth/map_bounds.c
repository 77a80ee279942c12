#include "shadow/depth/map_bounds.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "shadow/depth/depth_pass.h"

/* Lays all arrays out in `room`; returns their size. NULL: only that. */
static size_t lay_out(struct map_bounds *b, uint32_t side, unsigned maps, char *room)
{
    size_t used = 0;
    for (unsigned i = 0; i < BOUND_LEVELS; i++) {
        struct bound_level *l = &b->levels[i];
        l->blocks = (side + (BOUND_SIDE << i) - 1) / (BOUND_SIDE << i);
        size_t count = (size_t)maps * l->blocks * l->blocks;
        if (room) {
            l->around = (struct map_bound *)(room + used);
            l->own = l->around + count;
            l->own_nearest = (float *)(l->own + count);
        }
        used += count * (2 * sizeof *l->own + sizeof *l->own_nearest);
        used += (64 - used % 64) % 64;
    }
    if (room)
        b->nearest = (float *)(room + used);
    return used + (size_t)maps * b->levels[b->nearest_level].blocks * b->levels[b->nearest_level].blocks * sizeof *b->nearest;
}

bool map_bounds_prepare(struct map_bounds *b, const float *texels, uint32_t side, unsigned maps, unsigned nearest_level,
                        struct job_pool *pool, struct error *err)
{
    b->nearest_level = nearest_level;
    size_t bytes = lay_out(b, side, maps, NULL);
    if (b->bytes < bytes) {
        free(b->room);
        b->bytes = 0;
        bytes += (64 - bytes % 64) % 64;
        b->room = aligned_alloc(64, bytes);
        if (!b->room)
            return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for bounds of depth maps");
        b->bytes = bytes;
    }
    lay_out(b, side, maps, b->room);
    struct bound_job job = {b, texels, side, b->levels[BOUND_LEVELS - 1].blocks};
    const struct depth_kernel *kernel = depth_kernel_choose();
    job_pool_for(pool, (size_t)maps * job.bands, kernel->bound, &job);
    job_pool_for(pool, (size_t)maps * job.bands, kernel->bound_widen, &job);
    return true;
}

void map_bounds_finish(struct map_bounds *b)
{
    free(b->room);
    memset(b, 0, sizeof *b);
}
