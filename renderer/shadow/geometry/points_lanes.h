/* Which receivers' nearest depths leave them in doubt (geometry_points.h). Included by the kernels only (geometry_plain.c, geometry_avx2.c). */
#pragma once

#include "shadow/depth/depth_receivers.h"
#include "shadow/geometry/geometry_points.h"

/* Those of eight pixels that lie on texels of some map, to the list's end, where there is room. Returns how many; what tells of them is asked
 * for early. */
LANES_INLINE size_t put_points(const struct point_job *job, uint32_t x, uint32_t y, struct map_point *out)
{
    const struct depth_job *d = job->receivers;
    struct pixel room[LANES];
    struct receivers r;
    struct map_points m;
    uint32_t pixel = y * d->width + x;
    bool any = receivers_at(d, pixels_at(d, x, y, room), x, y, &r);
    put_values(d->visibility + pixel, lanes_if(r.receives, lanes_all(1)), d->width - x);
    if (!any)
        return 0;
    place_receivers(d, &r, &m);
    unsigned on = lanes_bits(m.on);
    if (!on)
        return 0;
    lanes nearness = d->orthographic ? m.far - m.depth : 1 / m.depth;
    size_t count = 0;
    for (; on; on &= on - 1) {
        unsigned i = (unsigned)__builtin_ctz(on);
        const struct geometry_map *map = &job->maps[m.map[i]];
        size_t at = geometry_map_at(map, (uint32_t)m.x[i], (uint32_t)m.y[i]);
        if (at == SIZE_MAX)
            continue;
        __builtin_prefetch(&map->cells[at]);
        out[count++] =
            (struct map_point){m.x[i], m.y[i], nearness[i], job->ids[pixel + i], (uint32_t)at, (uint32_t)m.map[i], pixel + i};
    }
    return count;
}

/* Of `count` points the doubtful ones, in their order; returns how many. */
static size_t keep_doubtful(const struct point_job *job, struct map_point *points, size_t count, uint32_t *starts)
{
    size_t kept = 0;
    for (size_t k = 0; k < count; k++) {
        struct map_point p = points[k];
        bool doubtful = p.n < job->maps[p.map].cells[p.at].nearest;
        points[kept] = p;
        kept += doubtful;
        starts[(size_t)point_tile(job, &p) * POINT_CHUNKS] += doubtful;
    }
    return kept;
}

/* One block's row, DEPTH_COLUMNS pixels at the most. */
LANES_INLINE bool find_in_row(const struct point_job *job, struct point_list *list, uint32_t *starts, uint32_t left, uint32_t y)
{
    uint32_t right = lesser(left + DEPTH_COLUMNS, job->receivers->width);
    if (!point_list_reserve(list, DEPTH_COLUMNS))
        return false;
    struct map_point *end = list->points + list->count;
    size_t count = 0;
    for (uint32_t x = left; x < right; x += LANES)
        count += put_points(job, x, y, end + count);
    list->count += keep_doubtful(job, end, count, starts);
    return true;
}

/* Every sixteenth stripe of the picture. */
static void find_points(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    struct point_job *job = context;
    const struct depth_job *d = job->receivers;
    struct point_list *list = &job->points->found[chunk];
    uint32_t *starts = job->points->starts + chunk;
    list->count = 0;
    for (size_t stripe = chunk; stripe < depth_job_count(d); stripe += POINT_CHUNKS) {
        uint32_t top = d->top + (uint32_t)stripe * DEPTH_ROWS, bottom = lesser(top + DEPTH_ROWS, d->bottom);
        for (uint32_t left = 0; left < d->width; left += DEPTH_COLUMNS)
            for (uint32_t y = top; y < bottom; y++)
                if (!find_in_row(job, list, starts, left, y)) {
                    job->failed[chunk] = true;
                    return;
                }
    }
}
