#include "shadow/geometry/coverage_lists.h"

#include "shadow/geometry/geometry_kernel.h"

/* At the map's ends. */
static void load_singly(struct coverage_window *w)
{
    for (int32_t y = 0; y < WINDOW_SIDE; y++)
        for (int32_t x = 0; x < WINDOW_SIDE; x++) {
            uint32_t id =
                geometry_map_triangle(w->map, (int32_t)w->left + x - WINDOW_AROUND, (int32_t)w->top + y - WINDOW_AROUND);
            w->id[y * WINDOW_SIDE + x] = id == MAP_NONE ? MAP_NONE : id & MAP_ID;
        }
}

void coverage_window_open(struct coverage_window *w, const struct geometry_map *m, uint32_t x, uint32_t y)
{
    w->map = m;
    w->left = x & ~(MAP_TILE - 1);
    w->top = y & ~(MAP_TILE - 1);
    w->first = geometry_map_at(m, w->left, w->top);
    if (w->left + MAP_TILE + WINDOW_AROUND > m->size || w->top + MAP_TILE + WINDOW_AROUND > m->size)
        load_singly(w);
    else
        geometry_kernel_choose()->load_window(w);
}

/* Two threads that make one list at once write the same; one of them is the first. Returns how many were new. */
static uint32_t make_some(struct coverage_texels *t)
{
    uint32_t made = 0;
    geometry_kernel_choose()->make_lists(t);
    for (unsigned k = 0; k < t->count; k++) {
        _Atomic uint32_t *note = (_Atomic uint32_t *)&t->window->map->notes[t->window->first + t->texel[k]];
        made += atomic_exchange_explicit(note, t->lists[k], memory_order_relaxed) == 0;
    }
    t->count = 0;
    return made;
}

uint32_t coverage_lists_make(struct coverage_window *w, const uint32_t wanted[MAP_TILE], unsigned nodes, unsigned pool)
{
    struct coverage_texels t = {.window = w, .nodes = nodes, .pool = pool};
    uint32_t made = 0;
    for (uint32_t y = 0; y < MAP_TILE; y++)
        for (uint32_t bits = wanted[y]; bits; bits &= bits - 1) {
            t.texel[t.count++] = (uint16_t)(y * MAP_TILE + (uint32_t)__builtin_ctz(bits));
            if (t.count == LISTS_TEXELS)
                made += make_some(&t);
        }
    return t.count > 0 ? made + make_some(&t) : made;
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
