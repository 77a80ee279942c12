/* Lists of some texels (coverage_lists.h), eight candidates at a time. Included by the kernels only (geometry_plain.c, geometry_avx2.c). */
#pragma once

#include "base/lanes.h"
#include "shadow/geometry/coverage_lists.h"
#include "shadow/geometry/light_lanes.h"

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

/* A texel at work: triangles that it or a neighbour keeps, and that its list may hold. */
struct candidates {
    float x, y;     /* its centre */
    unsigned count; /* those that touch it, its own included */
    uint32_t
        claim[8]; /* links to those that hold so many (0..4) of its corners; its own not among them; 7: that do not touch it */
};

/* Candidates to be judged. The last texel is nobody's: it fills the last eight. */
struct claims {
    const struct coverage_texels *texels;
    uint32_t hint;
    struct candidates of[LISTS_TEXELS + 1];
    unsigned count;
    uint32_t id[(LISTS_TEXELS + 1) * LANES];
    uint8_t texel[(LISTS_TEXELS + 1) * LANES], link[(LISTS_TEXELS + 1) * LANES];
};

/* Of links [first, first + 8) those to triangles that no link before leads to. `at`: the texel in the window. */
LANES_INLINE unsigned fresh_links(const uint32_t *at, unsigned first)
{
#define LINKED(k) ((int32_t)at[coverage_window_step(k)])
    const lane_ints number = {0, 1, 2, 3, 4, 5, 6, 7};
    lane_ints ids = {LINKED(first),     LINKED(first + 1), LINKED(first + 2), LINKED(first + 3),
                     LINKED(first + 4), LINKED(first + 5), LINKED(first + 6), LINKED(first + 7)};
    lane_ints fresh = (ids != (int32_t)MAP_NONE) & (ids != LINKED(0));
    if (!lanes_bits(fresh))
        return 0;
#pragma GCC unroll 32
    for (unsigned k = 1; k < first; k++)
        fresh &= ids != LINKED(k);
#pragma GCC unroll 8
    for (int k = 0; k < LANES - 1; k++)
        fresh &= (ids != LINKED(first + (unsigned)k)) | (number <= k);
    return lanes_bits(fresh);
#undef LINKED
}

/* Links [first, first + 8) of a texel. No branches: what is not fresh is written over. */
LANES_INLINE void put_candidates(struct claims *q, unsigned texel, unsigned first)
{
    unsigned t = q->texels->texel[texel], count = q->count;
    const uint32_t *at = q->texels->window->id + coverage_window_at(t % MAP_TILE, t / MAP_TILE);
    unsigned fresh = fresh_links(at, first);
    if (!fresh)
        return;
#pragma GCC unroll 8
    for (unsigned k = 0; k < LANES; k++) {
        q->id[count] = at[coverage_window_step(first + k)];
        q->texel[count] = (uint8_t)texel;
        q->link[count] = (uint8_t)(first + k);
        count += fresh >> k & 1;
    }
    q->count = count;
}

static void prefetch_indices(struct claims *q, unsigned first)
{
    for (unsigned k = first; k < first + LANES && k < q->count; k++)
        light_part_prefetch_indices(light_mesh_part(&q->texels->window->map->mesh, q->id[k], &q->hint), q->id[k]);
}

/* Eight candidates' corners, asked for early. */
LANES_INLINE void find_corners(struct claims *q, unsigned first, struct light_triangle t[LANES])
{
#pragma GCC unroll 8
    for (unsigned i = 0; i < LANES; i++) {
        uint32_t id = q->id[first + i];
        t[i] = light_part_triangle(light_mesh_part(&q->texels->window->map->mesh, id, &q->hint), id);
        for (int k = 0; k < 3; k++)
            __builtin_prefetch(t[i].corner[k]);
    }
}

/* Corners held by eight candidates from number `first` on. */
LANES_INLINE void judge_eight(struct claims *q, unsigned first, const struct light_triangle t[LANES], int32_t held[LANES])
{
    struct light_lanes c;
    lanes x, y;
    light_lanes_load(t, &c);
#pragma GCC unroll 8
    for (unsigned i = 0; i < LANES; i++) {
        x[i] = q->of[q->texel[first + i]].x;
        y[i] = q->of[q->texel[first + i]].y;
    }
    for (int k = 0; k < 3; k++) {
        c.x[k] -= x;
        c.y[k] -= y;
    }
    lane_ints_store(held, corners_held(c.x, c.y));
    lanes sum = c.x[0] + c.x[1] + c.x[2];
    for (unsigned odd = lanes_bits(sum != sum); odd; odd &= odd - 1) {
        unsigned i = (unsigned)__builtin_ctz(odd);
        const struct candidates *texel = &q->of[q->texel[first + i]];
        held[i] = wild_corners_held(q->texels->window->map, q->id[first + i], (uint32_t)texel->x, (uint32_t)texel->y);
    }
}

enum { INDICES_AHEAD = 8 * LANES, GROUPS_AHEAD = 4 };

LANES_INLINE void judge(struct claims *q)
{
    struct light_triangle ahead[GROUPS_AHEAD][LANES];
    for (unsigned k = 0; k < LANES; k++) {
        q->id[q->count + k] = q->id[0];
        q->texel[q->count + k] = LISTS_TEXELS;
    }
    for (unsigned first = 0; first < INDICES_AHEAD; first += LANES)
        prefetch_indices(q, first);
    for (unsigned group = 0; group < GROUPS_AHEAD - 1 && group * LANES < q->count; group++)
        find_corners(q, group * LANES, ahead[group]);
    for (unsigned group = 0; group * LANES < q->count; group++) {
        unsigned first = group * LANES, next = group + GROUPS_AHEAD - 1;
        int32_t held[LANES];
        prefetch_indices(q, first + INDICES_AHEAD);
        if (next * LANES < q->count)
            find_corners(q, next * LANES, ahead[next % GROUPS_AHEAD]);
        judge_eight(q, first, ahead[group % GROUPS_AHEAD], held);
#pragma GCC unroll 8
        for (unsigned i = 0; i < LANES; i++) {
            struct candidates *c = &q->of[q->texel[first + i]];
            c->count += held[i] >= 0;
            c->claim[held[i] & 7] |= 1u << (q->link[first + i] & 31);
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

static void begin(struct claims *q, const struct coverage_texels *t)
{
    q->texels = t;
    q->hint = q->count = 0;
    q->of[LISTS_TEXELS] = (struct candidates){0};
    for (unsigned k = 0; k < t->count; k++) {
        float x = (float)(t->window->left + t->texel[k] % MAP_TILE), y = (float)(t->window->top + t->texel[k] / MAP_TILE);
        q->of[k] = (struct candidates){.x = x + 0.5f, .y = y + 0.5f, .count = 1};
    }
}

/* Links [first, first + 8) of all texels that have places left. */
LANES_INLINE void add_links(struct claims *q, unsigned first)
{
    for (unsigned k = 0; k < q->texels->count; k++)
        if (first < COVERAGE_RING || q->of[k].count < q->texels->nodes)
            put_candidates(q, k, first);
    judge(q);
}

/* A texel's own triangle comes first, whatever it holds; the second ring only where the first leaves places free. */
static void make_lists(struct coverage_texels *t)
{
    struct claims q;
    begin(&q, t);
    add_links(&q, 1);
    if (t->pool > COVERAGE_RING) {
        add_links(&q, COVERAGE_RING);
        add_links(&q, COVERAGE_RING + LANES);
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
