#include "exact/tile_code.h"

#if defined(__AVX512F__) && defined(__AVX512DQ__)
const struct tile_kernel tile_avx512 = {tile_samples32, tile_point};
#else
const struct tile_kernel tile_avx512 = {0};
#endif
