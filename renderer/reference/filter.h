/* Certified signs in double, sixteen lines at a time. A line is known by its apex, which the packet shares, and a point of its own; so the
 * side of an edge it passes on is one linear form in that point, whose coefficients are made once per triangle.
 *
 * Error. u = 2^-53. A coefficient m_i = p q - r s of differences p, q, r, s of exact doubles is computed to within 4u (|pq| + |rs|): u for
 * each factor, u for the product, u for the difference (terms in u^2 aside). With d = point - anchor, itself to within u |d| and the
 * point's own error e, the form sum m_i d_i is computed to within sum M_i (8u |d_i| + e), M_i = |pq| + |rs|: four from m, one each from d
 * and the product, two from the sums. That is Shewchuk's static bound (7 + 56u) u for orient3d ("Adaptive Precision Floating-Point
 * Arithmetic and Fast Robust Geometric Predicates", 1997, section 4.3) with the point's error added. 16u is used, which leaves room for the
 * rounding of the bound itself. Underflow adds at most a few 2^-1074 times 1e18 while coordinates stay below 1e18: FILTER_UNDERFLOW. */
#pragma once

#include <math.h>
#include <stdbool.h>

#include "base/dmath.h"
#include "reference/exact.h"

#define FILTER_ROUNDING       0x1p-49 /* 16 u */
#define FILTER_UNDERFLOW      1e-300
#define FILTER_COORDINATE_MAX 1e18

enum { LANES = 16 };

/* One point (or direction) a lane; `error` bounds what each component may be off. */
struct lanes {
    _Alignas(64) double x[LANES];
    double y[LANES], z[LANES], error[LANES];
};

struct form {
    double m[3], bound[3]; /* coefficients; what bounds them: |pq| + |rs| */
    struct dvec3 anchor;
};

/* m = u x v. */
static inline struct form form_make(struct dvec3 u, struct dvec3 v, struct dvec3 anchor)
{
    return (struct form){
        .m = {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x},
        .bound = {fabs(u.y * v.z) + fabs(u.z * v.y), fabs(u.z * v.x) + fabs(u.x * v.z), fabs(u.x * v.y) + fabs(u.y * v.x)},
        .anchor = anchor,
    };
}

/* The form of edge a -> b seen from the apex. Directions (perspective camera rays) have no anchor: m . (eye - a) = 0. */
static inline struct form form_edge(const struct exact_apex *apex, bool directions, struct dvec3 a, struct dvec3 b)
{
    return form_make(apex->infinite ? apex->v : dvec3_sub(apex->v, a), dvec3_sub(b, a), directions ? dvec3(0, 0, 0) : a);
}

static inline struct form form_plane(const struct dvec3 triangle[3])
{
    return form_make(dvec3_sub(triangle[1], triangle[0]), dvec3_sub(triangle[2], triangle[0]), triangle[0]);
}

/* The form at one point of error `e`; *error bounds the difference from the exact value. */
static inline double form_value(const struct form *f, struct dvec3 p, double e, double *error)
{
    struct dvec3 d = dvec3_sub(p, f->anchor);
    *error = f->bound[0] * (FILTER_ROUNDING * fabs(d.x) + e) + f->bound[1] * (FILTER_ROUNDING * fabs(d.y) + e) +
             f->bound[2] * (FILTER_ROUNDING * fabs(d.z) + e) + FILTER_UNDERFLOW;
    return f->m[0] * d.x + f->m[1] * d.y + f->m[2] * d.z;
}

/* The form at a direction: anchor aside. */
static inline double form_slope(const struct form *f, struct dvec3 direction, double *error)
{
    struct form at = *f;
    at.anchor = dvec3(0, 0, 0);
    return form_value(&at, direction, 0, error);
}

/* Depth t at which origin + t * direction meets the form's plane; *error bounds how far it is off (INFINITY: cannot tell). */
static inline double form_depth(const struct form *f, struct dvec3 origin, struct dvec3 direction, double *error)
{
    double above_error, slope_error;
    double above = -form_value(f, origin, 0, &above_error), slope = form_slope(f, direction, &slope_error);
    double t = above / slope, room = fabs(slope) - slope_error;
    *error = room > 0 ? (above_error + fabs(t) * slope_error) / room * (1 + 0x1p-40) + 0x1p-50 * fabs(t) : INFINITY;
    return t;
}

/* Bit i of *positive or *negative is set where the form's sign at lane i is certain. */
void filter_signs(const struct form *f, const struct lanes *lanes, unsigned *positive, unsigned *negative);
