/* Signs of polynomials in doubles, never wrong. All finite doubles are dyadic rationals: each predicate scales its inputs to integers by
 * one power of two, which changes no sign, and computes with GMP integers; quotients stay homogeneous.
 *
 * Slow (some microseconds): reference/filter.h decides nearly everything first. Thread-safe. */
#pragma once

#include <stdbool.h>

#include "base/dmath.h"

/* A point on a sample's line, exactly. Perspective camera rays are known by their direction, whose line goes through the eye. */
struct exact_point {
    enum { EXACT_POINT, EXACT_DIRECTION, EXACT_ON_PLANE } kind;
    struct dvec3 v;                         /* the point, or the direction */
    struct dvec3 ray_origin, ray_direction; /* EXACT_ON_PLANE: where this ray (not unit) ... */
    struct dvec3 plane[3];                  /* ... meets the plane of these three points; not parallel to it */
};

/* What all lines of a packet go through: the eye, the light, or (infinite) a direction they share. */
struct exact_apex {
    bool infinite;
    struct dvec3 v;
};

/* Which side of directed edge a -> b the line apex-p passes: the sign of m . (p - a), m = (apex - a) x (b - a), or direction x (b - a).
 * An exact 0 is decided as if p were moved by (e, e^2, e^3) for an infinitely small e > 0: by the sign of m's first component that is not
 * zero (Edelsbrunner and Muecke, "Simulation of Simplicity", 1990). The move is the same for every edge and every triangle, so a closed
 * surface has no gap at its edges or vertices. Antisymmetric in (a, b). 0 only if m = 0: then apex lies in every plane through a, b. */
int exact_edge_side(const struct exact_apex *apex, const struct exact_point *p, struct dvec3 a, struct dvec3 b);

/* Sign of N . (p - a), N = (b - a) x (c - a). 0: in the plane, or no area. */
int exact_plane_side(const struct exact_point *p, const struct dvec3 triangle[3]);

/* Sign of N . (apex - a), or N . direction. */
int exact_apex_side(const struct exact_apex *apex, const struct dvec3 triangle[3]);

/* Sign of t1 - t2, where origin + t * direction lies in the planes of the two triangles; neither is parallel to the ray. */
int exact_compare_depths(struct dvec3 origin, struct dvec3 direction, const struct dvec3 first[3], const struct dvec3 second[3]);

/* Sign of t1 - depth; depth is finite. */
int exact_compare_depth(struct dvec3 origin, struct dvec3 direction, const struct dvec3 triangle[3], double depth);

/* The EXACT_ON_PLANE point to within one unit in the last place of each component. */
struct dvec3 exact_round_point(const struct exact_point *p);
