#include "shadow/geometry_kernel.h"
#include "shadow/lists_lanes.h"
#include "shadow/looks_lanes.h"
#include "shadow/points_lanes.h"

const struct geometry_kernel geometry_plain = {find_points, look_at_eight, load_window, make_lists};
