/* One tile of a geometry map, rasterized conservatively. */
#pragma once

#include "shadow/conservative.h"
#include "shadow/geometry_map.h"

/* The tile at (tile_x, tile_y) from `count` triangles and the map's wild ones, in any order; cells: MAP_TILE^2. */
void map_tile_rasterize(const struct geometry_map *m, uint32_t tile_x, uint32_t tile_y, const uint32_t *triangles, size_t count,
                        struct map_cell *cells);
