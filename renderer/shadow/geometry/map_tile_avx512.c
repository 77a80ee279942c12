#include "shadow/geometry/map_tile.h"

/* Not under GCC's AddressSanitizer, which lays 64-byte vectors out at 32 bytes when it looks for use after return (GCC bug 110027). */
#if defined(__AVX512F__) && !defined(__SANITIZE_ADDRESS__)
#include "shadow/geometry/map_tile_code.h"
map_tile_kernel *const map_tile_avx512 = rasterize;
#else
map_tile_kernel *const map_tile_avx512 = NULL;
#endif
