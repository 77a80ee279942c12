#include "shadow/asm/analysis_lanes.h"

#ifdef __AVX2__
const struct asm_kernel asm_avx2 = {resolve_rows, analyse_rows};
#else
const struct asm_kernel asm_avx2 = {0};
#endif
