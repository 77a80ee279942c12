/* The rules of docs/truth.md that are decided in double, in one place for everybody who must get the same bits: "Points in double",
 * "Receivers" (reach) and "Holes". No operation here may be fused or reordered. */
#pragma once

#include "reference/filter.h"
#include "trace/hole.h"

/* Where the ray meets the plane of `corners`, "Points in double". */
static inline struct dvec3 rule_point(struct dvec3 origin, struct dvec3 direction, const struct dvec3 corners[3])
{
    struct form plane = form_plane(corners);
    double error;
    return dvec3_mad(origin, direction, form_depth(&plane, origin, direction, &error));
}

/* Cone and range, in double at the point in double. */
static inline bool rule_within_reach(const struct light *light, struct dvec3 point)
{
    if (light->kind == LIGHT_DIRECTIONAL)
        return true;
    struct dvec3 v = dvec3_sub(point, light->position);
    double distance = dvec3_length(v);
    if (light->range > 0 && distance > light->range)
        return false;
    return light->kind != LIGHT_SPOT || dvec3_dot(v, light->direction) >= cos(light->outer) * distance;
}

/* True when `triangle` (0-based in the instance's mesh) is solid where the line from `origin` along `direction` meets it: Moeller and
 * Trumbore's barycentrics (1997) in double. */
static inline bool rule_is_solid(const struct scene *scene, uint32_t instance, uint32_t triangle, const struct dvec3 corners[3],
                                 struct dvec3 origin, struct dvec3 direction)
{
    struct dvec3 e1 = dvec3_sub(corners[1], corners[0]), e2 = dvec3_sub(corners[2], corners[0]);
    struct dvec3 p = dvec3_cross(direction, e2), s = dvec3_sub(origin, corners[0]), q = dvec3_cross(s, e1);
    double determinant = dvec3_dot(e1, p);
    double u = dvec3_dot(s, p) / determinant, v = dvec3_dot(direction, q) / determinant;
    return hole_is_solid(scene, instance, triangle, u, v);
}
