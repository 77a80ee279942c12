/* Which triangles each texel's list holds: coverage detection, papers/coverage-li-2017, 3.1. A list costs no triangle storage: it is links to
 * neighbouring texels, whose triangles they are.
 *
 * A list is made when a pixel first reads its texel, from the map alone: so it is the same whichever pixel asks first, texels that no
 * visible pixel reads cost nothing, and a camera that moves adds lists and changes none. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/geometry_map.h"

#define COVERAGE_NODES_MAX 16

/* Texels whose triangles a list may link, relative: the texel itself, the eight around (the paper's), and the sixteen around those, which
 * fill the places that the eight leave free. */
enum { COVERAGE_RING = 9, COVERAGE_POOL = 25 };
extern const int8_t coverage_pool[COVERAGE_POOL][2];

/* A list: bit k links texel coverage_pool[k]; of more than these bits it says that it was made. */
#define COVERAGE_LINKS 0x01ffffffu

/* `at` is (x, y)'s index in the map; pool: COVERAGE_RING or COVERAGE_POOL. Makes the list if need be; any thread. */
uint32_t coverage_list(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at, unsigned nodes, unsigned pool,
                       uint32_t *hint);

/* Whether texel `at` has a list already; which texels have depends on the pixels that asked, so nothing that shows may. */
bool coverage_list_made(const struct geometry_map *m, size_t at);

/* The triangles of a list: distinct drawn ids, MAP_OFF_EDGE taken off; returns how many. */
unsigned coverage_list_triangles(const struct geometry_map *m, uint32_t x, uint32_t y, uint32_t list,
                                 uint32_t out[COVERAGE_NODES_MAX]);
