/* Lists of some texels (coverage_lists.h), eight candidates at a time. Included by the kernels only (geometry_plain.c, geometry_avx2.c). */
#pragma once

#include <string.h>

#include "base/lanes.h"
#include "shadow/coverage_lists.h"
#include "shadow/light_lanes.h"

/* How many of its texel's corners each triangle holds (eq. 3); those are the midpoints between centres (eq. 2). Eq. 3's u, v >= 0 and
 * u + v <= 1 are the signs of the three edges. -1: it does not even touch the texel: conservative.h. */
LANES_INLINE lane_ints corners_held(const lanes x[3], const lanes y[3])
{
    const float half = 0.5f, reach = half + CONSERVATIVE_MARGIN;
    lane_ints touches =
        ((x[0] <= reach) | (x[1] <= reach) | (x[2] <= reach)) & ((y[0] <= reach) | (y[1] <= reach) | (y[2] <= reach)) &
        ((x[0] >= -reach) | (x[1] >= -reach) | (x[2] >= -reach)) & ((y[0] >= -reach) | (y[1] >= -reach) | (y[2] >= -reach));
    if (!lanes_bits(touches))
        return lane_ints_all(-1);
    lanes area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    lane_ints turn = (area < 0) & lane_ints_all(INT32_MIN), outside[4] = {};
    touches &= area == area;
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
    uint32_t tried[COVERAGE_POOL + LANES]; /* each once; the texel's own first */
    unsigned tried_count;
    unsigned count; /* those that touch the texel, its own included */
    uint32_t claim
        [8]; /* links to those that hold so many (0..4) of the texel's corners; its own not among them; 7: that do not touch it */
};

/* Candidates to be judged. */
struct claims {
    const struct coverage_texels *texels;
    uint32_t hint;
    struct candidates of[LISTS_TEXELS];
    unsigned count;
    uint32_t id[(LISTS_TEXELS + 1) * LANES];
    uint8_t texel[(LISTS_TEXELS + 1) * LANES], link[(LISTS_TEXELS + 1) * LANES];
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

/* Links [first, first + 8) of a texel. No branches: what is not fresh is written over. */
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
    unsigned fresh = fresh_ones(c, lane_ints_load(ids));
    if (!fresh)
        return;
#pragma GCC unroll 8
    for (unsigned k = 0; k < LANES; k++) {
        c->tried[c->tried_count] = q->id[q->count] = ids[k];
        q->texel[q->count] = (uint8_t)texel;
        q->link[q->count] = (uint8_t)(first + k);
        c->tried_count += fresh >> k & 1;
        q->count += fresh >> k & 1;
    }
}

/* Eight candidates' indices, or corners. */
LANES_INLINE void prefetch_eight(struct claims *q, unsigned first, bool corners)
{
    const struct light_mesh *m = &q->texels->window->map->mesh;
    for (unsigned k = first; k < first + LANES && k < q->count; k++) {
        const struct light_part *part = light_mesh_part(m, q->id[k], &q->hint);
        if (corners)
            light_part_prefetch_vertices(part, q->id[k]);
        else
            light_part_prefetch_indices(part, q->id[k]);
    }
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

enum { INDICES_AHEAD = 8 * LANES, CORNERS_AHEAD = 3 * LANES };

LANES_INLINE void judge(struct claims *q)
{
    for (unsigned first = 0; first < INDICES_AHEAD; first += LANES)
        prefetch_eight(q, first, false);
    for (unsigned first = 0; first < CORNERS_AHEAD; first += LANES)
        prefetch_eight(q, first, true);
    for (unsigned end = q->count; end % LANES; end++) {
        q->id[end] = q->id[0];
        q->texel[end] = q->texel[0];
    }
    for (unsigned first = 0; first < q->count; first += LANES) {
        int32_t held[LANES];
        prefetch_eight(q, first + INDICES_AHEAD, false);
        prefetch_eight(q, first + CORNERS_AHEAD, true);
        judge_eight(q, first, held);
        for (unsigned i = 0; i < LANES && first + i < q->count; i++) {
            struct candidates *c = &q->of[q->texel[first + i]];
            c->count += held[i] >= 0;
            c->claim[held[i] & 7] |= 1u << q->link[first + i];
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
    if (c->count <= places + 1)
        return c->claim[0] | c->claim[1] | c->claim[2] | c->claim[3] | c->claim[4];
    for (int held = 4; held >= 0 && places > 0; held--) {
        uint32_t chosen = lowest_bits(c->claim[held], places);
        list |= chosen;
        places -= (unsigned)__builtin_popcount(chosen);
    }
    return list;
}

static void begin(struct claims *q, struct coverage_texels *t)
{
    q->texels = t;
    q->hint = q->count = 0;
    for (unsigned k = 0; k < t->count; k++) {
        struct candidates *c = &q->of[k];
        c->tried[0] = t->window->id[coverage_window_at(t->texel[k] % MAP_TILE, t->texel[k] / MAP_TILE)];
        c->tried_count = c->count = 1;
        memset(c->claim, 0, sizeof c->claim);
    }
}

/* The texel's own triangle comes first, whatever it holds; the second ring only where the first leaves places free. */
static void make_lists(struct coverage_texels *t)
{
    struct claims q;
    begin(&q, t);
    for (unsigned first = 1; first < t->pool; first += LANES) {
        for (unsigned k = 0; k < t->count; k++)
            if (first < COVERAGE_RING || q.of[k].count < t->nodes)
                put_candidates(&q, k, first);
        judge(&q);
    }
    for (unsigned k = 0; k < t->count; k++)
        t->lists[k] = COVERAGE_MADE | 1 | choose_links(&q.of[k], t->nodes - 1);
}

/* The triangles that eight cells keep. */
LANES_INLINE lane_ints kept_by(const struct map_cell *cells)
{
    lane_ints low = lane_ints_load(cells), high = lane_ints_load(cells + LANES / 2);
    lane_ints id = __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15), none = id == (int32_t)MAP_NONE;
    return (id & (int32_t)MAP_ID) | none;
}

/* `rows` rows of a tile, or none where nothing is in it. */
LANES_INLINE void load_middle(uint32_t *out, const struct map_cell *cells, uint32_t rows)
{
    for (uint32_t y = 0; y < rows; y++, out += WINDOW_SIDE)
        for (uint32_t x = 0; x < MAP_TILE; x += LANES)
            lane_ints_store(out + x, cells ? kept_by(cells + y * MAP_TILE + x) : lane_ints_all((int32_t)MAP_NONE));
}

static const struct map_cell *cells_of(const struct geometry_map *m, int32_t x, int32_t y)
{
    if ((uint32_t)x >= m->size || (uint32_t)y >= m->size)
        return NULL;
    size_t at = geometry_map_at(m, (uint32_t)x, (uint32_t)y);
    return at == SIZE_MAX ? NULL : m->cells + at;
}

static uint32_t one_kept(const struct geometry_map *m, int32_t x, int32_t y)
{
    uint32_t id = geometry_map_triangle(m, x, y);
    return id == MAP_NONE ? MAP_NONE : id & MAP_ID;
}

/* The window's ids. It lies on the map wholly. */
static void load_window(struct coverage_window *w)
{
    const struct geometry_map *m = w->map;
    int32_t left = (int32_t)w->left, top = (int32_t)w->top, side = MAP_TILE;
    load_middle(w->id + WINDOW_AROUND, cells_of(m, left, top - WINDOW_AROUND), WINDOW_AROUND);
    load_middle(w->id + coverage_window_at(0, 0), cells_of(m, left, top), MAP_TILE);
    load_middle(w->id + coverage_window_at(0, MAP_TILE), cells_of(m, left, top + side), WINDOW_AROUND);
    for (int32_t y = -WINDOW_AROUND; y < side + WINDOW_AROUND; y++)
        for (int32_t k = 0; k < WINDOW_AROUND; k++) {
            uint32_t *row = w->id + (size_t)(y + WINDOW_AROUND) * WINDOW_SIDE;
            row[k] = one_kept(m, left + k - WINDOW_AROUND, top + y);
            row[side + WINDOW_AROUND + k] = one_kept(m, left + side + k, top + y);
        }
}
