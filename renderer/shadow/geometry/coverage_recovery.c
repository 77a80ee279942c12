#include "shadow/geometry/coverage_recovery.h"

/* Triangles of a texel's size and less: the one looked for is a few edges away. */
enum { STEPS_MAX = 15 };

enum { WAYS_AHEAD = 16 };

/* What lies across the edges of triangle `id`: adjacency is laid out as the scene's indices are. */
static const uint32_t *across(const struct coverage_asks *a, const struct light_part *part, uint32_t id)
{
    return a->adjacency->across + (part->indices - a->map->mesh.scene->indices) + 3 * (size_t)(id - part->first_triangle);
}

/* Way `w` goes one edge on. Whether it leads further is said without a branch: it is anyone's guess, here and where it arrives. */
static bool step(struct coverage_asks *a, struct coverage_way *w)
{
    const struct light_part *part = light_mesh_part(&a->map->mesh, w->triangle, &a->hint);
    uint32_t next = across(a, part, w->triangle)[w->beyond], id = next + part->first_triangle;
    bool ends = (next == SCENE_NONE) | (id == w->before) | ((a->known[w->point] & POINT_DARK) != 0);
    bool own = !ends & (id == a->points[w->point].id), on = !ends & !own;
    a->known[w->point] |= own ? POINT_HELD : 0;
    w->before = w->triangle;
    w->triangle = on ? id : w->triangle;
    light_part_prefetch_indices(part, w->triangle);
    return on;
}

/* Where way `w` has come, looked at: `k` of `l`. False: it ends. */
static bool arrive(struct coverage_asks *a, struct coverage_way *w, const struct map_looks *l, unsigned k)
{
    bool folded = w->area * l->area[k] < 0; /* the point lies beyond an outline */
    bool there = !folded & (l->beyond[k] < 0) & l->holds >> k;
    a->known[w->point] |= (uint8_t)(there * (l->before >> k & 1 ? POINT_DARK : POINT_HELD));
    w->beyond = l->beyond[k];
    w->area = l->area[k];
    return !folded & (l->beyond[k] >= 0);
}

/* Those of `count` ways that lead on move to the front; returns how many. */
static size_t step_all(struct coverage_asks *a, size_t count)
{
    size_t open = 0;
    for (size_t i = 0; i < count; i++) {
        struct coverage_way w = a->ways[i];
        uint32_t later = a->ways[i + WAYS_AHEAD < count ? i + WAYS_AHEAD : i].triangle;
        __builtin_prefetch(across(a, light_mesh_part(&a->map->mesh, later, &a->hint), later));
        bool on = step(a, &w);
        a->ways[open] = w;
        open += on;
    }
    return open;
}

static size_t look_at_all(struct coverage_asks *a, size_t count)
{
    size_t open = 0;
    for (size_t first = 0; first < count; first += LOOKS) {
        unsigned some = count - first < LOOKS ? (unsigned)(count - first) : LOOKS;
        for (size_t k = first + WAYS_AHEAD; k < first + WAYS_AHEAD + LOOKS && k < count; k++) {
            uint32_t id = a->ways[k].triangle;
            light_part_prefetch_vertices(light_mesh_part(&a->map->mesh, id, &a->hint), id);
        }
        struct map_looks l;
        for (unsigned k = 0; k < some; k++)
            map_looks_put(&l, k, &a->points[a->ways[first + k].point], a->ways[first + k].triangle);
        map_look(a->map, &l, some, &a->hint);
        for (unsigned k = 0; k < some; k++) {
            struct coverage_way w = a->ways[first + k];
            bool on = arrive(a, &w, &l, k);
            a->ways[open] = w;
            open += on;
        }
    }
    return open;
}

void coverage_recover(struct coverage_asks *a)
{
    size_t count = a->adjacency ? a->way_count : 0;
    for (int steps = 0; count > 0 && steps < STEPS_MAX; steps++)
        count = look_at_all(a, step_all(a, count));
    a->way_count = 0;
}
