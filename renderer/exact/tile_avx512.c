#include "exact/tile_code.h"

/* Not under GCC's AddressSanitizer, which lays 64-byte vectors out at 32 bytes when it looks for use after return (GCC bug 110027). */
#if defined(__AVX512F__) && defined(__AVX512DQ__) && !defined(__SANITIZE_ADDRESS__)
const struct tile_kernel tile_avx512 = {tile_samples32, tile_point};
#else
const struct tile_kernel tile_avx512 = {0};
#endif
