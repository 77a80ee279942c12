#include "exact/tile_code.h"

#ifdef __AVX2__
const struct tile_kernel tile_avx2 = {tile_samples32, tile_point};
#else
const struct tile_kernel tile_avx2 = {0};
#endif
