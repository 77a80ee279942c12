#include "shadow/geometry/geometry_kernel.h"
#include "shadow/geometry/lists_lanes.h"
#include "shadow/geometry/looks_lanes.h"
#include "shadow/geometry/points_lanes.h"

const struct geometry_kernel geometry_plain = {find_points, look_at_eight, load_window, make_lists};
