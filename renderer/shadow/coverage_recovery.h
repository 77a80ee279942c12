/* Boundary recovery: triangles so small that no texel kept them (papers/coverage-li-2017, 3.3). */
#pragma once

#include "scene/adjacency.h"
#include "shadow/geometry_maps.h"

/* A triangle that the point lies off, and how. */
struct coverage_way {
    const struct light_part *part;
    uint32_t id;
    struct light_sides sides;
};

/* From a triangle that a list holds over the mesh's edges to the triangle that holds the point: the paper projects the list's triangles along
 * the surface and probes around for the one that holds the point. GEOMETRY_OWN: the way leads to the point's own triangle.
 * GEOMETRY_ELSEWHERE: the mesh ends or turns away first. */
enum geometry_verdict coverage_recover(const struct geometry_map *m, const struct adjacency *adjacency,
                                       const struct coverage_way *from, const struct map_point *p, uint32_t *hint);
