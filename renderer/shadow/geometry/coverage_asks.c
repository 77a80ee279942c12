#include "shadow/geometry/coverage_asks.h"

#include <string.h>

#include "shadow/geometry/coverage_recovery.h"

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

/* No branches: what each answer is is anyone's guess. */
static void add_answers(struct coverage_asks *a, const struct coverage_pair *pairs, const struct map_looks *l, unsigned count)
{
    unsigned dark = l->holds & l->before, held = l->holds & l->may_shadow & ~l->before, aside = l->may_shadow & ~l->holds;
    for (unsigned k = 0; k < count; k++) {
        uint32_t point = pairs[k].point;
        a->known[point] |=
            (uint8_t)((dark >> k & 1) * POINT_DARK | (held >> k & 1) * POINT_HELD | (l->holds >> k & 1) * POINT_COVERED);
        a->ways[a->way_count] = (struct coverage_way){point, pairs[k].triangle, SCENE_NONE, l->beyond[k], l->area[k]};
        a->way_count += aside >> k & (l->beyond[k] >= 0);
    }
}

static void ask_some(struct coverage_asks *a, const struct coverage_pair *pairs, unsigned count)
{
    struct map_looks l;
    for (unsigned k = 0; k < count; k++)
        map_looks_put(&l, k, &a->points[pairs[k].point], pairs[k].triangle);
    map_look(a->map, &l, count, &a->hint);
    add_answers(a, pairs, &l, count);
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
    prefetch_some(a, LOOKS);
    for (size_t first = 0; first < a->pair_count; first += LOOKS) {
        size_t left = a->pair_count - first;
        prefetch_some(a, first + 2 * LOOKS);
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
    bool own = id == a->points[point].id;
    a->known[point] |= own ? POINT_HELD : 0;
    light_part_prefetch_indices(light_mesh_part(&a->map->mesh, id, &a->hint), id);
    a->pairs[a->pair_count] = (struct coverage_pair){point, id};
    a->pair_count += !own;
}

void coverage_asks_finish(struct coverage_asks *a)
{
    coverage_asks_finish_pairs(a);
    coverage_recover(a);
}
