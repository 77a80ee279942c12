#include "shadow/coverage_asks.h"

#include <string.h>

#include "shadow/coverage_recovery.h"

void coverage_asks_open(struct coverage_asks *a, const struct geometry_map *m, const struct adjacency *adjacency,
                        const struct map_point *points, size_t count)
{
    a->map = m;
    a->adjacency = adjacency;
    a->points = points;
    a->hint = 0;
    a->pair_count = a->way_count = 0;
    memset(a->known, 0, count * sizeof *a->known);
}

/* Looked at: `k` of `l`. */
static void add_answer(struct coverage_asks *a, const struct coverage_pair *pair, const struct map_looks *l, unsigned k)
{
    unsigned bit = 1u << k;
    if (pair->triangle == a->points[pair->point].id)
        a->known[pair->point] |= POINT_HELD;
    else if (l->holds & l->before & bit)
        a->known[pair->point] |= POINT_DARK;
    else if (l->may_shadow & l->holds & bit)
        a->known[pair->point] |= POINT_HELD;
    else if (l->may_shadow & bit && l->beyond[k] >= 0)
        a->ways[a->way_count++] = (struct coverage_way){pair->point, pair->triangle, SCENE_NONE, l->beyond[k], l->area[k]};
}

static void ask_some(struct coverage_asks *a, const struct coverage_pair *pairs, unsigned count)
{
    struct map_looks l;
    for (unsigned k = 0; k < count; k++)
        map_looks_put(&l, k, &a->points[pairs[k].point], pairs[k].triangle);
    map_look(a->map, &l, count, &a->hint);
    for (unsigned k = 0; k < count; k++)
        add_answer(a, &pairs[k], &l, k);
}

static void prefetch_some(struct coverage_asks *a, size_t first)
{
    for (size_t k = first; k < first + LOOKS && k < a->pair_count; k++) {
        uint32_t id = a->pairs[k].triangle;
        light_part_prefetch_vertices(light_mesh_part(&a->map->mesh, id, &a->hint), id);
    }
}

void coverage_asks_finish_pairs(struct coverage_asks *a)
{
    prefetch_some(a, 0);
    for (size_t first = 0; first < a->pair_count; first += LOOKS) {
        size_t left = a->pair_count - first;
        prefetch_some(a, first + LOOKS);
        if (a->way_count + LOOKS > ASKS_QUEUE)
            coverage_recover(a);
        ask_some(a, a->pairs + first, left < LOOKS ? (unsigned)left : LOOKS);
    }
    a->pair_count = 0;
}

void coverage_asks_put(struct coverage_asks *a, uint32_t point, uint32_t id)
{
    if (a->pair_count == ASKS_QUEUE)
        coverage_asks_finish_pairs(a);
    light_part_prefetch_indices(light_mesh_part(&a->map->mesh, id, &a->hint), id);
    a->pairs[a->pair_count++] = (struct coverage_pair){point, id};
}

void coverage_asks_finish(struct coverage_asks *a)
{
    coverage_asks_finish_pairs(a);
    coverage_recover(a);
}
