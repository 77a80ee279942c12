/* What remains to be said of a point that no known triangle holds. */
#pragma once

#include "shadow/geometry/geometry_maps.h"

/* Whether the point lies in the middle of something nearer to the light: between four texel centres that are all covered by triangles wholly before
 * it. A surface of triangles smaller than texels, few of which any texel keeps, is shadowed so; beside an outline it is not. */
bool surrounded(const struct geometry_map *m, const struct map_point *p, uint32_t *hint);
