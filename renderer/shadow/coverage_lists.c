#include "shadow/coverage_lists.h"

#include <stdatomic.h>

#include "shadow/light_lanes.h"

#define INLINE static inline __attribute__((always_inline))
#define MADE   0x80000000u

const int8_t coverage_pool[COVERAGE_POOL][2] = {
    {0, 0}, {1, 0},  {-1, 0}, {0, 1},   {0, -1}, {1, 1},  {-1, 1}, {1, -1},  {-1, -1}, {2, 0},  {-2, 0}, {0, 2},   {0, -2},
    {2, 1}, {2, -1}, {-2, 1}, {-2, -1}, {1, 2},  {-1, 2}, {1, -2}, {-1, -2}, {2, 2},   {-2, 2}, {2, -2}, {-2, -2},
};

/* Triangles that the texel or a neighbour keeps and that touch it, each once, and their claims to a place. */
struct candidates {
    uint32_t id[32]; /* the texel's own first, which also fills the places not taken */
    unsigned count;
    uint32_t claim[5]; /* links to those that hold so many of the texel's corners; its own not among them */
};

/* How many of the texel's corners each triangle holds (eq. 3); those are the midpoints between centres (eq. 2). Eq. 3's u, v >= 0 and
 * u + v <= 1 are the signs of the three edges. -1: it does not even touch the texel: conservative.h. */
INLINE void corners_held(const struct light_lanes *t, lanes_int *out)
{
    const float half = 0.5f, reach = half + CONSERVATIVE_MARGIN;
    lanes_float area = (t->x[1] - t->x[0]) * (t->y[2] - t->y[0]) - (t->x[2] - t->x[0]) * (t->y[1] - t->y[0]);
    lanes_int turn = (area < 0) & ((lanes_int){} + INT32_MIN), magnitude = (lanes_int){} + 0x7fffffff, outside[4] = {};
    lanes_int touches = area == area;
    for (int k = 0; k < 3; k++) {
        int j = k == 2 ? 0 : k + 1;
        lanes_float a = (lanes_float)((lanes_int)(t->y[k] - t->y[j]) ^ turn),
                    b = (lanes_float)((lanes_int)(t->x[j] - t->x[k]) ^ turn);
        lanes_float c = -a * t->x[k] - b * t->y[k], ha = half * a, hb = half * b;
        lanes_float wide = (lanes_float)((lanes_int)a & magnitude) + (lanes_float)((lanes_int)b & magnitude);
        touches &= c + reach * wide >= 0;
        outside[0] |= c - ha - hb < 0;
        outside[1] |= c + ha - hb < 0;
        outside[2] |= c - ha + hb < 0;
        outside[3] |= c + ha + hb < 0;
    }
    touches &= ((t->x[0] <= reach) | (t->x[1] <= reach) | (t->x[2] <= reach)) &
               ((t->y[0] <= reach) | (t->y[1] <= reach) | (t->y[2] <= reach));
    touches &= ((t->x[0] >= -reach) | (t->x[1] >= -reach) | (t->x[2] >= -reach)) &
               ((t->y[0] >= -reach) | (t->y[1] >= -reach) | (t->y[2] >= -reach));
    *out = ((4 + outside[0] + outside[1] + outside[2] + outside[3]) & touches) | ~touches;
}

/* A wild triangle's, one by one; those that hold none do not count. */
static int wild_corners_held(const struct geometry_map *m, const struct light_part *part, uint32_t id, uint32_t x, uint32_t y)
{
    struct light_hit hit;
    int held = 0;
    for (unsigned k = 0; k < 4; k++)
        held += light_wild_hit(&m->mesh, part, id, (float)(x + (k & 1)), (float)(y + (k >> 1)), &hit);
    return held ? held : -1;
}

/* What eight triangles hold of texel (x, y). */
INLINE void claims(const struct geometry_map *m, const uint32_t *ids, uint32_t x, uint32_t y, uint32_t *hint, lanes_int *out)
{
    const struct light_part *part[CONSERVATIVE_LANES];
    struct light_triangle t[CONSERVATIVE_LANES];
    struct light_lanes over;
#pragma GCC unroll 8
    for (int lane = 0; lane < CONSERVATIVE_LANES; lane++) {
        part[lane] = light_mesh_part(&m->mesh, ids[lane], hint);
        t[lane] = light_part_triangle(part[lane], ids[lane]);
    }
    light_lanes_load(t, &over);
    for (int k = 0; k < 3; k++) {
        over.x[k] -= (float)x + 0.5f;
        over.y[k] -= (float)y + 0.5f;
    }
    corners_held(&over, out);
    lanes_float sum = over.x[0] + over.x[1] + over.x[2];
    lanes_int odd = sum != sum;
    if (!LANES_ANY(odd))
        return;
    for (int lane = 0; lane < CONSERVATIVE_LANES; lane++)
        if (odd[lane])
            (*out)[lane] = wild_corners_held(m, part[lane], ids[lane], x, y);
}

INLINE bool is_known(const struct candidates *c, uint32_t id)
{
    lanes_int known = {};
    for (unsigned i = 0; i < c->count; i += CONSERVATIVE_LANES)
        known |= *(const lanes_int_loose *)&c->id[i] == (int32_t)id;
    return LANES_ANY(known);
}

/* What eight texels of the pool keep, from number `first` on. */
INLINE void kept_around(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at, unsigned first,
                        uint32_t ids[CONSERVATIVE_LANES])
{
    const int8_t(*step)[2] = coverage_pool + first;
    /* Most texels have their neighbours in their own tile. */
    if (x % MAP_TILE - 2 < MAP_TILE - 4 && y % MAP_TILE - 2 < MAP_TILE - 4)
#pragma GCC unroll 8
        for (unsigned k = 0; k < CONSERVATIVE_LANES; k++)
            ids[k] = m->cells[(ptrdiff_t)at + step[k][1] * (ptrdiff_t)MAP_TILE + step[k][0]].triangle;
    else
        for (unsigned k = 0; k < CONSERVATIVE_LANES; k++)
            ids[k] = geometry_map_triangle(m, (int32_t)x + step[k][0], (int32_t)y + step[k][1]);
}

INLINE void add_candidates(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at, unsigned first, uint32_t *hint,
                           struct candidates *c)
{
    uint32_t ids[CONSERVATIVE_LANES];
    int32_t corners[CONSERVATIVE_LANES];
    kept_around(m, x, y, at, first, ids);
    lanes_int kept = *(const lanes_int_loose *)ids, named = kept & (int32_t)MAP_ID, own = (lanes_int){} + (int32_t)c->id[0];
    lanes_int other = (kept != (int32_t)MAP_NONE) & (named != own), held;
    if (!LANES_ANY(other))
        return;
    *(lanes_int_loose *)ids = (named & other) | (own & ~other);
    claims(m, ids, x, y, hint, &held);
    *(lanes_int_loose *)corners = held;
    other &= held >= 0;
    for (unsigned open = LANES_BITS(other); open; open &= open - 1) {
        unsigned k = (unsigned)__builtin_ctz(open);
        if (is_known(c, ids[k]))
            continue;
        c->id[c->count++] = ids[k];
        c->claim[corners[k]] |= 1u << (first + k);
    }
}

/* At most `most` of the bits, lowest first. */
static uint32_t lowest_bits(uint32_t bits, unsigned most)
{
    uint32_t kept = 0;
    for (; bits && most > 0; bits &= bits - 1, most--)
        kept |= bits & -bits;
    return kept;
}

/* The texel's own triangle comes first, whatever it holds; the second ring only where the first leaves places free. */
INLINE uint32_t make_list_inline(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at, unsigned nodes, unsigned pool,
                                 uint32_t *hint)
{
    struct candidates c = {.count = 1};
    *(lanes_int_loose *)&c.id[0] = (lanes_int){} + (int32_t)(m->cells[at].triangle & MAP_ID);
    for (int i = CONSERVATIVE_LANES; i < 32; i += CONSERVATIVE_LANES)
        *(lanes_int_loose *)&c.id[i] = *(lanes_int_loose *)&c.id[0];
    add_candidates(m, x, y, at, 1, hint, &c);
    for (unsigned first = COVERAGE_RING; first < pool && c.count < nodes; first += CONSERVATIVE_LANES)
        add_candidates(m, x, y, at, first, hint, &c);
    uint32_t list = MADE | 1;
    unsigned places = nodes - 1;
    for (int held = 4; held >= 0 && places > 0; held--) {
        uint32_t chosen = lowest_bits(c.claim[held], places);
        list |= chosen;
        places -= (unsigned)__builtin_popcount(chosen);
    }
    return list;
}

#ifdef __x86_64__
/* The same arithmetic in wider vectors (no contraction), so the same bits. */
__attribute__((target("avx2"))) static uint32_t make_list_avx2(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at,
                                                               unsigned nodes, unsigned pool, uint32_t *hint)
{
    return make_list_inline(m, x, y, at, nodes, pool, hint);
}
#endif

static uint32_t make_list(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at, unsigned nodes, unsigned pool,
                          uint32_t *hint)
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2"))
        return make_list_avx2(m, x, y, at, nodes, pool, hint);
#endif
    return make_list_inline(m, x, y, at, nodes, pool, hint);
}

uint32_t coverage_list(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at, unsigned nodes, unsigned pool,
                       uint32_t *hint)
{
    /* Two threads that make one list at once write the same. */
    _Atomic uint32_t *note = (_Atomic uint32_t *)&m->notes[at];
    uint32_t list = atomic_load_explicit(note, memory_order_relaxed);
    if (list == 0) {
        list = make_list(m, x, y, at, nodes, pool, hint);
        atomic_store_explicit(note, list, memory_order_relaxed);
    }
    return list;
}

bool coverage_list_made(const struct geometry_map *m, size_t at)
{
    return atomic_load_explicit((_Atomic uint32_t *)&m->notes[at], memory_order_relaxed) != 0;
}

unsigned coverage_list_triangles(const struct geometry_map *m, uint32_t x, uint32_t y, uint32_t list,
                                 uint32_t out[COVERAGE_NODES_MAX])
{
    unsigned count = 0;
    for (uint32_t links = list & COVERAGE_LINKS; links; links &= links - 1) {
        const int8_t *step = coverage_pool[__builtin_ctz(links)];
        out[count++] = geometry_map_triangle(m, (int32_t)x + step[0], (int32_t)y + step[1]) & MAP_ID;
    }
    return count;
}
