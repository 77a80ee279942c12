/* Vectors of eight as in depth_avx2.c, with twice the registers and masks of their own. */
#include "shadow/depth/bound_lanes.h"
#include "shadow/depth/depth_filters.h"
#include "shadow/depth/map_raster_lanes.h"
#include "shadow/depth/soft_lanes.h"

#ifdef __AVX512VL__
const struct depth_kernel depth_avx512 = {filter_rows, soft_term_rows, soft_blur_rows, raster_band, bound_band, bound_widen_band};
#else
const struct depth_kernel depth_avx512 = {0};
#endif
