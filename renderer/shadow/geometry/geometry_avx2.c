#include "shadow/geometry/geometry_kernel.h"
#include "shadow/geometry/lists_lanes.h"
#include "shadow/geometry/looks_lanes.h"
#include "shadow/geometry/points_lanes.h"

#ifdef __AVX2__
const struct geometry_kernel geometry_avx2 = {find_points, look_at_eight, load_window, make_lists};
#else
const struct geometry_kernel geometry_avx2 = {0};
#endif
