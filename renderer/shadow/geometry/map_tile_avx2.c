#include "shadow/geometry/map_tile.h"

#ifdef __AVX2__
#include "shadow/geometry/map_tile_code.h"
map_tile_kernel *const map_tile_avx2 = rasterize;
#else
map_tile_kernel *const map_tile_avx2 = NULL;
#endif
