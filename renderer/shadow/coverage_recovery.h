/* Boundary recovery: triangles so small that no texel kept them (papers/coverage-li-2017, 3.3). */
#pragma once

#include "scene/adjacency.h"
#include "shadow/geometry_maps.h"

/* From triangle `id`, which a list holds and the point lies off, over the mesh's edges to the triangle that holds the point:
 * the paper projects the list's triangles along the surface and probes around for the one that holds the point. GEOMETRY_ELSEWHERE: the
 * mesh ends or turns away first. */
enum geometry_verdict coverage_recover(const struct geometry_map *m, const struct adjacency *adjacency, uint32_t id,
                                       const struct map_point *p, uint32_t *hint);
