/* One tile of a geometry map, rasterized conservatively. */
#pragma once

#include "shadow/geometry/geometry_map.h"

/* The tile at (tile_x, tile_y) from `count` triangles and the map's wild ones, in any order; those after the first `front` are tested for being
 * hidden by those, which changes nothing but the time that it takes. cells: MAP_TILE^2. */
typedef void map_tile_kernel(const struct geometry_map *m, uint32_t tile_x, uint32_t tile_y, const uint32_t *triangles,
                             size_t front, size_t count, struct map_cell *cells);
/* Compiled once an instruction set, to the same bits; the latter two NULL where the compiler has none. */
extern map_tile_kernel *const map_tile_plain, *const map_tile_avx2, *const map_tile_avx512;

/* The best that this machine runs. */
map_tile_kernel *map_tile_choose(void);
