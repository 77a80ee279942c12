/* Which triangles each texel's list holds: coverage detection, papers/coverage-li-2017, 3.1. A list costs no triangle storage: it is links to
 * neighbouring texels, whose triangles they are.
 *
 * A list is made when a pixel first reads its texel, from the map alone: so it is the same whichever pixel asks first, texels that no
 * visible pixel reads cost nothing, and a camera that moves adds lists and changes none. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/geometry/geometry_map.h"

#define COVERAGE_NODES_MAX 16

/* Texels whose triangles a list may link, relative: the texel itself, the eight around (the paper's), and the sixteen around those, which
 * fill the places that the eight leave free. */
enum { COVERAGE_RING = 9, COVERAGE_POOL = 25 };
static const int8_t coverage_pool[COVERAGE_POOL][2] = {
    {0, 0}, {1, 0},  {-1, 0}, {0, 1},   {0, -1}, {1, 1},  {-1, 1}, {1, -1},  {-1, -1}, {2, 0},  {-2, 0}, {0, 2},   {0, -2},
    {2, 1}, {2, -1}, {-2, 1}, {-2, -1}, {1, 2},  {-1, 2}, {1, -2}, {-1, -2}, {2, 2},   {-2, 2}, {2, -2}, {-2, -2},
};

/* A list, kept in the map's notes: bit k links texel coverage_pool[k]; of more than these bits it says that it was made. */
#define COVERAGE_LINKS 0x01ffffffu
#define COVERAGE_MADE  0x80000000u

/* What the texels of a tile keep, and two texels around it. A thread's work space. */
enum { WINDOW_AROUND = 2, WINDOW_SIDE = MAP_TILE + 2 * WINDOW_AROUND };
struct coverage_window {
    const struct geometry_map *map;
    uint32_t left, top;                     /* of the tile, texels */
    size_t first;                           /* of its texels, in cells and notes */
    uint32_t id[WINDOW_SIDE * WINDOW_SIDE]; /* MAP_OFF_EDGE taken off; MAP_NONE */
};

/* Texel (x, y) of the tile in the window. */
static inline size_t coverage_window_at(uint32_t x, uint32_t y)
{
    return (size_t)(y + WINDOW_AROUND) * WINDOW_SIDE + x + WINDOW_AROUND;
}
/* What texel `at` of cells and notes keeps, one of the tile's. */
static inline const uint32_t *coverage_window_id(const struct coverage_window *w, size_t at)
{
    return &w->id[coverage_window_at(at % MAP_TILE, at / MAP_TILE % MAP_TILE)];
}
/* From a texel's place in the window to that of link k. */
static inline ptrdiff_t coverage_window_step(unsigned k)
{
    return coverage_pool[k][1] * (ptrdiff_t)WINDOW_SIDE + coverage_pool[k][0];
}

/* Of the tile that holds texel (x, y). */
void coverage_window_open(struct coverage_window *w, const struct geometry_map *m, uint32_t x, uint32_t y);

/* Makes the lists of the tile's texels whose bit (x % MAP_TILE) of `wanted` (y % MAP_TILE) is set; each keeps a triangle. pool: COVERAGE_RING or
 * COVERAGE_POOL. Several threads may make the same ones. Returns how many had none before. */
uint32_t coverage_lists_make(struct coverage_window *w, const uint32_t wanted[MAP_TILE], unsigned nodes, unsigned pool);

/* Texel `at`'s list; 0: it has none. Which texels have depends on the pixels that asked, so nothing that shows may. */
static inline uint32_t coverage_list(const struct geometry_map *m, size_t at)
{
    return atomic_load_explicit((_Atomic uint32_t *)&m->notes[at], memory_order_relaxed);
}

/* The triangles of a list of texel (x, y): distinct drawn ids, MAP_OFF_EDGE taken off; returns how many. */
unsigned coverage_list_triangles(const struct geometry_map *m, uint32_t x, uint32_t y, uint32_t list,
                                 uint32_t out[COVERAGE_NODES_MAX]);

/* At work: texels whose lists are made together. */
enum { LISTS_TEXELS = 64 };
struct coverage_texels {
    const struct coverage_window *window;
    unsigned nodes, pool, count;
    uint16_t texel[LISTS_TEXELS]; /* in the tile */
    uint32_t lists[LISTS_TEXELS]; /* found */
};
