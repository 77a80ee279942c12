/* The tiles' work. Included by tile_*.c, each compiled for one instruction set. */
#pragma once

#include "exact/visible.h"

/* The samples in `mask` of one pixel, which all see receiver `id`: those that receive, and those of them that are lit. */
static inline uint32_t shade_group(struct tile_scratch *s, const struct tile_job *job, uint32_t id, uint32_t mask, uint32_t x,
                                   uint32_t y, uint32_t tile, uint32_t *lit)
{
    struct receiver *r = receiver_get(s, job, id);
    struct group g = {.scratch = s, .job = job, .receiver = r, .x = x, .y = y, .open = mask, .certain = r->certain};
    struct quad quad;
    if (r->certain && !r->faces)
        return 0;
    bool reaches_all = light_reaches_all(job->light);
    if (reaches_all && r->certain && r->recent.count) {
        group_try_recent(&g);
        if (!g.open) {
            s->counts.receivers += (unsigned)__builtin_popcount(mask);
            return mask;
        }
    }
    bool listed = candidates_ready(&g, r, tile);
    bool placed = r->certain && !(listed && reaches_all) && quad_make(&quad, job, r, x, y, 1);
    int reached = reaches_all ? 1 : placed ? quad_within_reach(job->light, &quad) : -1;
    uint32_t receivers = mask;
    if (!r->certain || reached < 0) {
        for (uint32_t bits = mask; bits; bits &= bits - 1) {
            unsigned i = (unsigned)__builtin_ctz(bits);
            struct sample_ray ray = group_ray(&g, i);
            if (!slow_receives(&s->slow, &ray, id))
                receivers &= ~(1u << i);
        }
        g.open &= receivers;
    } else if (reached == 0) {
        return 0;
    }
    s->counts.receivers += (unsigned)__builtin_popcount(receivers);
    if (listed)
        for (int i = 0; i < r->candidate_count && g.open; i++)
            group_try(&g, r->candidates[i], true);
    else if (g.open)
        group_cast(&g, r, placed ? &quad : NULL);
    if (!g.open && receivers)
        group_was_shadowed(&g, r);
    *lit |= g.open;
    return receivers;
}

static inline uint32_t shade_pixel(struct tile_scratch *s, const struct tile_job *job, uint32_t pixel, uint32_t x, uint32_t y,
                                   uint32_t tile, uint32_t *lit)
{
    uint32_t receivers = 0;
    for (uint32_t left = ~0u; left;) {
        uint32_t id = s->id[pixel][__builtin_ctz(left)], mask = 0;
        for (int i = 0; i < 32; i += WIDTH)
            mask |= wide_same(s->id[pixel] + i, id) << i;
        left &= ~mask;
        if (id != SCENE_NONE)
            receivers |= shade_group(s, job, id, mask, x, y, tile, lit);
    }
    return receivers;
}

struct tile_pixel {
    uint32_t x, y;
};

/* Block by block, since receivers keep their candidates for one. */
static inline struct tile_pixel pixel_in_order(uint32_t i)
{
    const uint32_t inside = BLOCK_SIDE * BLOCK_SIDE, block = i / inside;
    return (struct tile_pixel){block % BLOCKS_PER_ROW * BLOCK_SIDE + i % BLOCK_SIDE,
                               block / BLOCKS_PER_ROW * BLOCK_SIDE + i % inside / BLOCK_SIDE};
}

static inline void tile_clear(struct tile_scratch *s, uint32_t width, uint32_t height)
{
    for (uint32_t p = 0; p < TILE_PIXELS; p++) {
        s->key_error[p] = 0;
        s->farthest[p] = p % TILE_SIDE < width && p / TILE_SIDE < height ? -INFINITY : INFINITY;
        for (int i = 0; i < 32; i++) {
            s->key[p][i] = -INFINITY;
            s->id[p][i] = SCENE_NONE;
        }
    }
}

static inline void tile_samples32(void *context, size_t index, unsigned worker)
{
    const struct tile_job *job = context;
    struct tile_scratch *s = &job->scratch[worker];
    const struct bins *bins = job->bins;
    const struct view *view = job->view;
    uint32_t x0 = (uint32_t)(index % bins->columns) * TILE_SIDE, y0 = (uint32_t)(index / bins->columns) * TILE_SIDE;
    uint32_t width = view->width - x0 < TILE_SIDE ? view->width - x0 : TILE_SIDE,
             height = view->height - y0 < TILE_SIDE ? view->height - y0 : TILE_SIDE;
    uint32_t first = bins->first[index], count = bins->first[index + 1] - first;
    bool empty = count == 0;
    if (!empty) {
        tile_clear(s, width, height);
        show_all(s, job, bins->entries + first, count, x0, y0, width, height);
    }
    for (uint32_t i = 0; i < TILE_PIXELS; i++) {
        uint32_t x = pixel_in_order(i).x, y = pixel_in_order(i).y, lit = 0;
        if (x >= width || y >= height)
            continue;
        uint32_t receivers = empty ? 0 : shade_pixel(s, job, y * TILE_SIDE + x, x0 + x, y0 + y, (uint32_t)index, &lit);
        size_t at = (size_t)(y0 + y) * view->width + x0 + x;
        job->receivers[at] = receivers;
        job->lit[at] = lit;
        job->visibility[at] = receivers ? (float)__builtin_popcount(lit) / (float)__builtin_popcount(receivers) : 0;
    }
}

/* 1 lit. */
static inline bool point_is_lit(struct tile_scratch *s, const struct tile_job *job, uint32_t id, uint32_t x, uint32_t y,
                                uint32_t tile)
{
    if (id == SCENE_NONE || job->triangles->flags[id] & TRIANGLE_IGNORED)
        return false;
    struct receiver *r = receiver_get(s, job, id);
    struct group g = {.scratch = s, .job = job, .receiver = r, .x = x, .y = y, .open = 1, .center = true};
    struct quad quad;
    g.anywhere = !inside_of(job, r, x + 0.5, y + 0.5);
    g.certain = !g.anywhere;
    if (!g.anywhere && !r->faces)
        return false;
    bool reaches_all = !g.anywhere && light_reaches_all(job->light);
    if (reaches_all && r->recent.count) {
        group_try_recent(&g);
        s->counts.receivers += !g.open;
        if (!g.open)
            return false;
    }
    bool listed = candidates_ready(&g, r, tile);
    bool placed = r->certain && !(listed && reaches_all) && quad_make(&quad, job, r, x + 0.5, y + 0.5, 0);
    int reached = reaches_all ? 1 : placed ? (r->faces ? quad_within_reach(job->light, &quad) : 0) : -1;
    g.certain |= placed;
    if (reached < 0) {
        struct sample_ray ray = group_ray(&g, 0);
        reached = slow_receives(&s->slow, &ray, id);
    }
    if (!reached)
        return false;
    s->counts.receivers++;
    if (!listed)
        group_cast(&g, r, placed ? &quad : NULL);
    else
        for (int i = 0; i < r->candidate_count && g.open; i++)
            group_try(&g, r->candidates[i], true);
    if (!g.open)
        group_was_shadowed(&g, r);
    return g.open;
}

static inline bool is_one_receiver(const struct tile_job *job, const uint32_t *ids)
{
    bool same = true;
    for (uint32_t y = 0; y < BLOCK_SIDE; y++)
        for (uint32_t x = 0; x < BLOCK_SIDE; x++)
            same &= ids[y * job->view->width + x] == ids[0];
    return same;
}

/* 1 lit, 0 not: all pixel centres of the block at (x, y); -1: ask one by one. */
static inline int block_is_lit(struct tile_scratch *s, const struct tile_job *job, uint32_t x, uint32_t y, uint32_t tile)
{
    const uint32_t *ids = job->ids + (size_t)y * job->view->width + x;
    if (!is_one_receiver(job, ids))
        return -1;
    if (*ids == SCENE_NONE || job->triangles->flags[*ids] & TRIANGLE_IGNORED)
        return 0;
    struct receiver *r = receiver_get(s, job, *ids);
    struct group g = {.scratch = s, .job = job, .receiver = r, .x = x, .y = y, .open = 1, .center = true};
    const double ends[2] = {0.5, BLOCK_SIDE - 0.5};
    int inside = inside_of(job, r, x + ends[0], y + ends[0]);
    /* Half-planes are convex. */
    for (int i = 1; i < 4 && inside; i++)
        inside = inside_of(job, r, x + ends[i % 2], y + ends[i / 2]) == inside ? inside : 0;
    if (!inside || (r->faces && !light_reaches_all(job->light)))
        return -1;
    if (!r->faces)
        return 0;
    if (!candidates_ready(&g, r, tile) || r->candidate_count != 0)
        return -1;
    s->counts.receivers += BLOCK_SIDE * BLOCK_SIDE;
    return 1;
}

static inline void tile_point(void *context, size_t index, unsigned worker)
{
    const struct tile_job *job = context;
    struct tile_scratch *s = &job->scratch[worker];
    const struct view *view = job->view;
    uint32_t columns = (view->width + TILE_SIDE - 1) / TILE_SIDE;
    uint32_t x0 = (uint32_t)(index % columns) * TILE_SIDE, y0 = (uint32_t)(index / columns) * TILE_SIDE;
    int block = -1;
    for (uint32_t i = 0; i < TILE_PIXELS; i++) {
        struct tile_pixel p = pixel_in_order(i);
        uint32_t x = x0 + p.x, y = y0 + p.y;
        if (i % (BLOCK_SIDE * BLOCK_SIDE) == 0)
            block = x + BLOCK_SIDE <= view->width && y + BLOCK_SIDE <= view->height ? block_is_lit(s, job, x, y, (uint32_t)index)
                                                                                    : -1;
        if (x >= view->width || y >= view->height)
            continue;
        size_t at = (size_t)y * view->width + x;
        bool lit = block < 0 ? point_is_lit(s, job, job->ids[at], x, y, (uint32_t)index) : block;
        job->visibility[at] = lit ? 1.0f : 0.0f;
    }
}
