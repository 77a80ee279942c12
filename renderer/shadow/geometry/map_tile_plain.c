#include "shadow/geometry/map_tile_code.h"

map_tile_kernel *const map_tile_plain = rasterize;
