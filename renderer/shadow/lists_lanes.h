/* Lists of some texels (coverage_lists.h), eight candidates at a time. Included by the kernels only (geometry_plain.c, geometry_avx2.c). */
#pragma once

#include "base/lanes.h"
#include "shadow/coverage_lists.h"
#include "shadow/light_lanes.h"

/* How many of its texel's corners each triangle holds (eq. 3); those are the midpoints between centres (eq. 2). Eq. 3's u, v >= 0 and
 * u + v <= 1 are the signs of the three edges. -1: it does not even touch the texel: conservative.h. */
LANES_INLINE lane_ints corners_held(const lanes x[3], const lanes y[3])
{
    const float half = 0.5f, reach = half + CONSERVATIVE_MARGIN;
    lanes area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    lane_ints turn = (area < 0) & lane_ints_all(INT32_MIN), outside[4] = {};
    lane_ints touches = area == area;
    for (int k = 0; k < 3; k++) {
        int j = k == 2 ? 0 : k + 1;
        lanes a = (lanes)((lane_ints)(y[k] - y[j]) ^ turn), b = (lanes)((lane_ints)(x[j] - x[k]) ^ turn);
        lanes c = -a * x[k] - b * y[k], ha = half * a, hb = half * b;
        touches &= c + reach * (lanes_abs(a) + lanes_abs(b)) >= 0;
        outside[0] |= c - ha - hb < 0;
        outside[1] |= c + ha - hb < 0;
        outside[2] |= c - ha + hb < 0;
        outside[3] |= c + ha + hb < 0;
    }
    touches &= ((x[0] <= reach) | (x[1] <= reach) | (x[2] <= reach)) & ((y[0] <= reach) | (y[1] <= reach) | (y[2] <= reach));
    touches &=
        ((x[0] >= -reach) | (x[1] >= -reach) | (x[2] >= -reach)) & ((y[0] >= -reach) | (y[1] >= -reach) | (y[2] >= -reach));
    return ((4 + outside[0] + outside[1] + outside[2] + outside[3]) & touches) | ~touches;
}

/* A wild triangle's, one by one; those that hold none do not count. */
static int wild_corners_held(const struct geometry_map *m, uint32_t id, uint32_t x, uint32_t y)
{
    uint32_t hint = 0;
    const struct light_part *part = light_mesh_part(&m->mesh, id, &hint);
    struct light_hit hit;
    int held = 0;
    for (unsigned k = 0; k < 4; k++)
        held += light_wild_hit(&m->mesh, part, id, (float)(x + (k & 1)), (float)(y + (k >> 1)), &hit);
    return held ? held : -1;
}

/* What a texel's list may hold: triangles that it or a neighbour keeps. */
struct candidates {
    uint32_t tried[COVERAGE_POOL]; /* each once; the texel's own first */
    unsigned tried_count;
    unsigned count;    /* those that touch the texel, its own included */
    uint32_t claim[5]; /* links to those that hold so many of the texel's corners; its own not among them */
};

/* Candidates to be judged. */
struct claims {
    const struct coverage_texels *texels;
    uint32_t hint;
    struct candidates of[LISTS_TEXELS];
    unsigned count;
    uint32_t id[LISTS_TEXELS * LANES];
    uint8_t texel[LISTS_TEXELS * LANES], link[LISTS_TEXELS * LANES];
};

/* Those of eight ids that are none's, known, or another's before. */
LANES_INLINE unsigned fresh_ones(const struct candidates *c, lane_ints ids)
{
    const lane_ints number = {0, 1, 2, 3, 4, 5, 6, 7};
    lane_ints fresh = ids != (int32_t)MAP_NONE;
    for (unsigned k = 0; k < c->tried_count; k++)
        fresh &= ids != (int32_t)c->tried[k];
    if (!lanes_bits(fresh))
        return 0;
#pragma GCC unroll 8
    for (int k = 0; k < LANES - 1; k++)
        fresh &= (ids != ids[k]) | (number <= k);
    return lanes_bits(fresh);
}

/* Links [first, first + 8) of a texel. */
LANES_INLINE void put_candidates(struct claims *q, unsigned texel, unsigned first)
{
    const struct coverage_window *w = q->texels->window;
    struct candidates *c = &q->of[texel];
    unsigned t = q->texels->texel[texel];
    const uint32_t *at = w->id + coverage_window_at(t % MAP_TILE, t / MAP_TILE);
    uint32_t ids[LANES];
#pragma GCC unroll 8
    for (unsigned k = 0; k < LANES; k++)
        ids[k] = at[coverage_window_step[first + k]];
    for (unsigned fresh = fresh_ones(c, lane_ints_load(ids)); fresh; fresh &= fresh - 1) {
        unsigned k = (unsigned)__builtin_ctz(fresh);
        light_part_prefetch_indices(light_mesh_part(&w->map->mesh, ids[k], &q->hint), ids[k]);
        c->tried[c->tried_count++] = ids[k];
        q->id[q->count] = ids[k];
        q->texel[q->count] = (uint8_t)texel;
        q->link[q->count++] = (uint8_t)(first + k);
    }
}

static void prefetch_eight(struct claims *q, unsigned first)
{
    for (unsigned k = first; k < first + LANES && k < q->count; k++)
        light_part_prefetch_vertices(light_mesh_part(&q->texels->window->map->mesh, q->id[k], &q->hint), q->id[k]);
}

/* Corners held by eight candidates from number `first` on, which may repeat. */
LANES_INLINE void judge_eight(struct claims *q, unsigned first, int32_t held[LANES])
{
    const struct coverage_window *w = q->texels->window;
    struct light_triangle t[LANES];
    struct light_lanes c;
    uint32_t x[LANES], y[LANES];
#pragma GCC unroll 8
    for (unsigned i = 0; i < LANES; i++) {
        uint32_t id = q->id[first + i], texel = q->texels->texel[q->texel[first + i]];
        t[i] = light_part_triangle(light_mesh_part(&w->map->mesh, id, &q->hint), id);
        x[i] = w->left + texel % MAP_TILE;
        y[i] = w->top + texel / MAP_TILE;
    }
    light_lanes_load(t, &c);
    lanes left = lanes_from(lane_ints_load(x)) + 0.5f, top = lanes_from(lane_ints_load(y)) + 0.5f;
    for (int k = 0; k < 3; k++) {
        c.x[k] -= left;
        c.y[k] -= top;
    }
    lane_ints_store(held, corners_held(c.x, c.y));
    lanes sum = c.x[0] + c.x[1] + c.x[2];
    for (unsigned odd = lanes_bits(sum != sum); odd; odd &= odd - 1) {
        unsigned i = (unsigned)__builtin_ctz(odd);
        held[i] = wild_corners_held(w->map, q->id[first + i], x[i], y[i]);
    }
}

LANES_INLINE void judge(struct claims *q)
{
    prefetch_eight(q, 0);
    for (unsigned end = q->count; end % LANES && end > 0; end++) {
        q->id[end] = q->id[0];
        q->texel[end] = q->texel[0];
    }
    for (unsigned first = 0; first < q->count; first += LANES) {
        int32_t held[LANES];
        prefetch_eight(q, first + LANES);
        judge_eight(q, first, held);
        for (unsigned i = 0; i < LANES && first + i < q->count; i++) {
            struct candidates *c = &q->of[q->texel[first + i]];
            if (held[i] < 0)
                continue;
            c->count++;
            c->claim[held[i]] |= 1u << q->link[first + i];
        }
    }
    q->count = 0;
}

/* At most `most` of the bits, lowest first. */
static uint32_t lowest_bits(uint32_t bits, unsigned most)
{
    uint32_t kept = 0;
    for (; bits && most > 0; bits &= bits - 1, most--)
        kept |= bits & -bits;
    return kept;
}

static uint32_t choose_links(const struct candidates *c, unsigned places)
{
    uint32_t list = 0;
    for (int held = 4; held >= 0 && places > 0; held--) {
        uint32_t chosen = lowest_bits(c->claim[held], places);
        list |= chosen;
        places -= (unsigned)__builtin_popcount(chosen);
    }
    return list;
}

/* A texel's own triangle comes first, whatever it holds; the second ring only where the first leaves places free. */
static void make_lists(struct coverage_texels *t)
{
    struct claims q = {.texels = t};
    for (unsigned k = 0; k < t->count; k++) {
        q.of[k].tried[0] = t->window->id[coverage_window_at(t->texel[k] % MAP_TILE, t->texel[k] / MAP_TILE)];
        q.of[k].tried_count = q.of[k].count = 1;
    }
    for (unsigned first = 1; first < t->pool; first += LANES) {
        for (unsigned k = 0; k < t->count; k++)
            if (first < COVERAGE_RING || q.of[k].count < t->nodes)
                put_candidates(&q, k, first);
        judge(&q);
    }
    for (unsigned k = 0; k < t->count; k++)
        t->lists[k] = COVERAGE_MADE | 1 | choose_links(&q.of[k], t->nodes - 1);
}
