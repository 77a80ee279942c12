#include "shadow/coverage_lists.h"

#include <stdatomic.h>

#include "shadow/conservative.h"

#define MADE 0x80000000u

const int8_t coverage_pool[COVERAGE_POOL][2] = {
    {0, 0}, {1, 0},  {-1, 0}, {0, 1},   {0, -1}, {1, 1},  {-1, 1}, {1, -1},  {-1, -1}, {2, 0},  {-2, 0}, {0, 2},   {0, -2},
    {2, 1}, {2, -1}, {-2, 1}, {-2, -1}, {1, 2},  {-1, 2}, {1, -2}, {-1, -2}, {2, 2},   {-2, 2}, {2, -2}, {-2, -2},
};

/* A triangle that a neighbour keeps, and its claim to a place. */
struct candidate {
    uint32_t id, link;
    unsigned corners; /* of the texel, that it holds (eq. 3); 0: touches the texel */
};

/* The texel's corners are the midpoints between centres (eq. 2): whole numbers. */
static unsigned corners_held(const struct geometry_map *m, const struct light_part *part, uint32_t id, uint32_t x, uint32_t y)
{
    struct light_hit hit;
    unsigned held = 0;
    for (unsigned k = 0; k < 4; k++)
        held += light_triangle_hit(&m->mesh, part, id, (float)(x + (k & 1)), (float)(y + (k >> 1)), &hit);
    return held;
}

static bool touches(const struct light_part *part, uint32_t id, uint32_t x, uint32_t y)
{
    struct light_triangle t = light_part_triangle(part, id);
    float px[3], py[3];
    for (int k = 0; k < 3; k++) {
        px[k] = t.corner[k]->x;
        py[k] = t.corner[k]->y;
    }
    return conservative_touches(px, py, (float)x, (float)y);
}

static unsigned find_candidates(const struct geometry_map *m, uint32_t x, uint32_t y, unsigned pool, uint32_t *hint,
                                struct candidate *out)
{
    unsigned count = 0;
    for (unsigned k = 0; k < pool; k++) {
        uint32_t id = geometry_map_triangle(m, (int32_t)x + coverage_pool[k][0], (int32_t)y + coverage_pool[k][1]);
        bool known = id == MAP_NONE;
        id &= MAP_ID;
        for (unsigned i = 0; i < count && !known; i++)
            known = out[i].id == id;
        if (known)
            continue;
        const struct light_part *part = light_mesh_part(&m->mesh, id, hint);
        unsigned held = k == 0 ? 5 : corners_held(m, part, id, x, y); /* the texel's own comes first */
        if (held || touches(part, id, x, y))
            out[count++] = (struct candidate){id, 1u << k, held};
    }
    return count;
}

static uint32_t make_list(const struct geometry_map *m, uint32_t x, uint32_t y, unsigned nodes, uint32_t *hint)
{
    struct candidate candidates[COVERAGE_POOL];
    unsigned count = find_candidates(m, x, y, nodes > COVERAGE_RING ? COVERAGE_POOL : COVERAGE_RING, hint, candidates);
    uint32_t list = MADE;
    for (unsigned held = 6; held-- > 0 && nodes > 0;)
        for (unsigned i = 0; i < count && nodes > 0; i++)
            if (candidates[i].corners == held) {
                list |= candidates[i].link;
                nodes--;
            }
    return list;
}

uint32_t coverage_list(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at, unsigned nodes, uint32_t *hint)
{
    /* Two threads that make one list at once write the same. */
    _Atomic uint32_t *note = (_Atomic uint32_t *)&m->notes[at];
    uint32_t list = atomic_load_explicit(note, memory_order_relaxed);
    if (list == 0) {
        list = make_list(m, x, y, nodes, hint);
        atomic_store_explicit(note, list, memory_order_relaxed);
    }
    return list;
}

unsigned coverage_list_triangles(const struct geometry_map *m, uint32_t x, uint32_t y, uint32_t list,
                                 uint32_t out[COVERAGE_NODES_MAX])
{
    unsigned count = 0;
    for (uint32_t links = list & ~MADE; links; links &= links - 1) {
        const int8_t *step = coverage_pool[__builtin_ctz(links)];
        out[count++] = geometry_map_triangle(m, (int32_t)x + step[0], (int32_t)y + step[1]) & MAP_ID;
    }
    return count;
}
