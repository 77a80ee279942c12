#include "shadow/coverage_lists.h"

#include <stdatomic.h>
#include <string.h>

#include "shadow/conservative.h"

#define INLINE static inline __attribute__((always_inline))
#define MADE   0x80000000u

const int8_t coverage_pool[COVERAGE_POOL][2] = {
    {0, 0}, {1, 0},  {-1, 0}, {0, 1},   {0, -1}, {1, 1},  {-1, 1}, {1, -1},  {-1, -1}, {2, 0},  {-2, 0}, {0, 2},   {0, -2},
    {2, 1}, {2, -1}, {-2, 1}, {-2, -1}, {1, 2},  {-1, 2}, {1, -2}, {-1, -2}, {2, 2},   {-2, 2}, {2, -2}, {-2, -2},
};

/* A triangle that a neighbour keeps, and its claim to a place. */
struct candidate {
    uint32_t id, link;
    int corners; /* of the texel, that it holds; 0: touches the texel; 5: the texel's own */
};

/* Eight triangles over one texel, a lane each; coordinates from the texel's centre. Lanes without a triangle are not numbers. */
struct lanes_over {
    lanes_float x[3], y[3];
};

static void put_lane(struct lanes_over *over, int lane, const struct light_triangle *t, float x, float y)
{
    for (int k = 0; k < 3; k++) {
        over->x[k][lane] = t->corner[k]->x - x;
        over->y[k][lane] = t->corner[k]->y - y;
    }
}

/* How many of the texel's corners each triangle holds (eq. 3); those are the midpoints between centres (eq. 2). Eq. 3's u, v >= 0 and
 * u + v <= 1 are the signs of the three edges. -1: it does not even touch the texel: conservative.h. */
INLINE void corners_held(const struct lanes_over *t, lanes_int *out)
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

#ifdef __x86_64__
__attribute__((target("avx2"))) static void corners_held_avx2(const struct lanes_over *t, lanes_int *out)
{
    corners_held(t, out);
}
#endif

static void corners_held_any(const struct lanes_over *t, lanes_int *out)
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        corners_held_avx2(t, out);
        return;
    }
#endif
    corners_held(t, out);
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

/* What eight triangles hold of texel (x, y); MAP_NONE among them: -1. */
static void claims(const struct geometry_map *m, const uint32_t *ids, uint32_t x, uint32_t y, uint32_t *hint, lanes_int *out)
{
    struct lanes_over over;
    const struct light_part *wild[CONSERVATIVE_LANES] = {NULL};
    bool any_wild = false;
    memset(&over, 0xff, sizeof over);
    for (int lane = 0; lane < CONSERVATIVE_LANES; lane++) {
        if (ids[lane] == MAP_NONE)
            continue;
        const struct light_part *part = light_mesh_part(&m->mesh, ids[lane], hint);
        struct light_triangle t = light_part_triangle(part, ids[lane]);
        if (light_triangle_wild(&t)) {
            wild[lane] = part;
            any_wild = true;
        } else {
            put_lane(&over, lane, &t, (float)x + 0.5f, (float)y + 0.5f);
        }
    }
    corners_held_any(&over, out);
    for (int lane = 0; any_wild && lane < CONSERVATIVE_LANES; lane++)
        if (wild[lane])
            (*out)[lane] = wild_corners_held(m, wild[lane], ids[lane], x, y);
}

static bool is_known(const struct candidate *candidates, unsigned count, uint32_t id)
{
    for (unsigned i = 0; i < count; i++)
        if (candidates[i].id == id)
            return true;
    return false;
}

/* Eight texels of the pool, from number `first` on. */
static unsigned add_candidates(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at, unsigned first, uint32_t *hint,
                               struct candidate *out, unsigned count)
{
    /* Most texels have their neighbours in their own tile. */
    bool within = x % MAP_TILE - 2 < MAP_TILE - 4 && y % MAP_TILE - 2 < MAP_TILE - 4;
    uint32_t ids[CONSERVATIVE_LANES];
    lanes_int held;
    bool any = false;
    for (unsigned k = 0; k < CONSERVATIVE_LANES; k++) {
        int32_t dx = coverage_pool[first + k][0], dy = coverage_pool[first + k][1];
        uint32_t id = within ? m->cells[(ptrdiff_t)at + dy * (ptrdiff_t)MAP_TILE + dx].triangle
                             : geometry_map_triangle(m, (int32_t)x + dx, (int32_t)y + dy);
        ids[k] = id == MAP_NONE || (id & MAP_ID) == out[0].id ? MAP_NONE : id & MAP_ID;
        any |= ids[k] != MAP_NONE;
    }
    if (!any)
        return count;
    claims(m, ids, x, y, hint, &held);
    for (unsigned k = 0; k < CONSERVATIVE_LANES; k++)
        if (held[k] >= 0 && !is_known(out, count, ids[k]))
            out[count++] = (struct candidate){ids[k], 1u << (first + k), held[k]};
    return count;
}

/* The texel's own triangle comes first, whatever it holds; the second ring only where the first leaves places free. */
static unsigned find_candidates(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at, unsigned nodes, unsigned pool,
                                uint32_t *hint, struct candidate *out)
{
    unsigned count = 1;
    out[0] = (struct candidate){m->cells[at].triangle & MAP_ID, 1, 5};
    count = add_candidates(m, x, y, at, 1, hint, out, count);
    for (unsigned first = COVERAGE_RING; first < pool && count < nodes; first += CONSERVATIVE_LANES)
        count = add_candidates(m, x, y, at, first, hint, out, count);
    return count;
}

static uint32_t make_list(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at, unsigned nodes, unsigned pool,
                          uint32_t *hint)
{
    struct candidate candidates[COVERAGE_POOL];
    unsigned count = find_candidates(m, x, y, at, nodes, pool, hint, candidates);
    uint32_t list = MADE;
    for (int held = 5; held >= 0 && nodes > 0; held--)
        for (unsigned i = 0; i < count && nodes > 0; i++)
            if (candidates[i].corners == held) {
                list |= candidates[i].link;
                nodes--;
            }
    return list;
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
