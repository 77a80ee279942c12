/* One tap, a square of taps, or a square where its corners differ. Included by the kernels only (depth_plain.c, depth_avx*.c). */
#pragma once

#include "shadow/depth/depth_receivers.h"

LANES_INLINE lane_ints blocked_at(const struct depth_job *job, const struct map_points *m, lane_ints x, lane_ints y, lanes depth)
{
    return texel_blocks(job, lanes_gather(job->texels, texel_at(job, m, x, y)), depth, m->near, m->range, m->far);
}

/* What a square is compared with. */
struct one_point {
    lanes depth, near, range, far;
    const float *map;
    int32_t x, y; /* texel */
};

/* These two: the weight of the texels that lie before the point. Texels past a map's edge count as those on it. */
static int32_t square_at_edge(const struct depth_job *job, const struct one_point *p)
{
    const struct depth_square *s = job->square;
    int32_t reach = s->side / 2, last = job->side - 1, dark = 0;
    for (int32_t j = 0; j < s->side; j++) {
        int32_t y = p->y + j - reach;
        y = y < 0 ? 0 : y > last ? last : y;
        for (int32_t i = 0; i < s->side; i++) {
            int32_t x = p->x + i - reach;
            x = x < 0 ? 0 : x > last ? last : x;
            lanes stored = lanes_all(p->map[(size_t)y * (size_t)job->side + (size_t)x]);
            dark += texel_blocks(job, stored, p->depth, p->near, p->range, p->far)[0] & s->weight[j][i];
        }
    }
    return dark;
}

/* A row of the square at a time: neighbours lie side by side in the map. A vector may reach past the row, and past the map into
 * LIGHT_MAPS_PAST, where weights are 0. */
LANES_INLINE int32_t square_inside(const struct depth_job *job, const struct one_point *p, int side)
{
    const struct depth_square *s = job->square;
    const float *row = p->map + (size_t)(p->y - side / 2) * (size_t)job->side + (size_t)(p->x - side / 2);
    lane_ints dark = lane_ints_all(0);
    for (int j = 0; j < side; j++, row += job->side)
        for (int i = 0; i < side; i += LANES)
            dark +=
                texel_blocks(job, lanes_load(row + i), p->depth, p->near, p->range, p->far) & lane_ints_load(&s->weight[j][i]);
    return lane_ints_sum(dark);
}

LANES_INLINE float square_lit(const struct depth_job *job, const struct one_point *p)
{
    int32_t side = job->square->side, reach = side / 2, last = job->side - 1 - reach;
    bool inside = p->x >= reach && p->y >= reach && p->x <= last && p->y <= last;
    int32_t dark = !inside ? square_at_edge(job, p) : side == 5 ? square_inside(job, p, 5) : square_inside(job, p, side);
    return (float)(job->square->total - dark) / (float)job->square->total;
}

/* Puts the square's share where `wanted`. */
LANES_INLINE lanes squares_lit(const struct depth_job *job, const struct map_points *m, lanes depth, lane_ints wanted, lanes lit)
{
    lane_ints x = lanes_truncate(m->x), y = lanes_truncate(m->y);
    for (unsigned bits = lanes_bits(wanted); bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        struct one_point p = {.depth = lanes_all(depth[i]),
                              .near = lanes_all(m->near[i]),
                              .range = lanes_all(m->range[i]),
                              .far = lanes_all(m->far[i]),
                              .map = job->texels + (size_t)m->map[i] * (size_t)job->side * (size_t)job->side,
                              .x = x[i],
                              .y = y[i]};
        lit[i] = square_lit(job, &p);
    }
    return lit;
}

/* Zhang, Yang, Liu 2012, section 2.3. */
LANES_INLINE lanes adaptive_lit(const struct depth_job *job, const struct map_points *m, lanes depth)
{
    lane_ints x = lanes_truncate(m->x), y = lanes_truncate(m->y), reach = lane_ints_all(job->square->side / 2);
    lane_ints zero = lane_ints_all(0), last = lane_ints_all(job->side - 1);
    lane_ints x0 = lane_ints_max(x - reach, zero), x1 = lane_ints_min(x + reach, last);
    lane_ints y0 = lane_ints_max(y - reach, zero), y1 = lane_ints_min(y + reach, last);
    lane_ints a = blocked_at(job, m, x0, y0, depth), b = blocked_at(job, m, x1, y0, depth);
    lane_ints c = blocked_at(job, m, x0, y1, depth), d = blocked_at(job, m, x1, y1, depth);
    lane_ints all = a & b & c & d, any = a | b | c | d;
    return squares_lit(job, m, depth, m->on & any & ~all, lanes_if(~all, lanes_all(1)));
}

LANES_INLINE lanes filtered(const struct depth_job *job, const struct map_points *m, lanes depth)
{
    switch (job->filter) {
    case DEPTH_SQUARE: return squares_lit(job, m, depth, m->on, lanes_all(1));
    case DEPTH_ADAPTIVE: return adaptive_lit(job, m, depth);
    default: return lanes_if(~blocked_at(job, m, lanes_truncate(m->x), lanes_truncate(m->y), depth), lanes_all(1));
    }
}

enum { EARLY_LANES = 4 };

/* The row below finds its texels about as far on as this row found its from the row above: `before`, made this row's. */
LANES_INLINE void fetch_early(const struct depth_job *job, const struct map_points *m, int32_t before[EARLY_LANES])
{
    lane_ints at = texel_at(job, m, lanes_truncate(m->x), lanes_truncate(m->y));
    for (int i = 0; i < EARLY_LANES; i++) {
        int32_t now = at[2 * i + 1];
        __builtin_prefetch((const void *)((uintptr_t)job->texels + sizeof(float) * (uintptr_t)(2 * (intptr_t)now - before[i])));
        before[i] = now;
    }
}

LANES_INLINE lanes filter_pixels(const struct depth_job *job, uint32_t x, uint32_t y, int32_t before[EARLY_LANES])
{
    struct pixel room[LANES];
    struct receivers r;
    if (!receivers_at(job, pixels_at(job, x, y, room), x, y, &r))
        return lanes_all(0);
    struct map_points m;
    place_receivers(job, &r, &m);
    lanes lit = lanes_all(1);
    if (lanes_bits(m.on)) {
        fetch_early(job, &m, before);
        lit = filtered(job, &m, biased_depth(job, &r, &m));
        lit = lanes_pick(m.on, job->umbra + (1 - job->umbra) * lit, lanes_all(1));
    }
    return lanes_if(r.receives, lit);
}

static void filter_rows(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct depth_job *job = context;
    uint32_t top = job->top + (uint32_t)index * DEPTH_ROWS, bottom = lesser(top + DEPTH_ROWS, job->bottom);
    int32_t before[DEPTH_COLUMNS / LANES][EARLY_LANES] = {{0}};
    for (uint32_t left = 0; left < job->width; left += DEPTH_COLUMNS)
        for (uint32_t y = top, right = lesser(left + DEPTH_COLUMNS, job->width); y < bottom; y++)
            for (uint32_t x = left; x < right; x += LANES)
                put_values(job->visibility + (size_t)y * job->width + x, filter_pixels(job, x, y, before[(x - left) / LANES]),
                           job->width - x);
}
