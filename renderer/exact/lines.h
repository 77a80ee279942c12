/* Linear forms of a triangle, its three edges and its plane at once, as the camera's picture sees them.
 *
 * The identity (shared/EXACT.md). Let q(x, y) be what varies over the picture: the ray's direction (perspective; the origin o stands) or
 * its origin (orthographic; the direction d stands). A form m . (p - a) has, at picture position (x, y),
 *   perspective:   fixed F = m . (o - a)   varying V(x, y) = m . q
 *   orthographic:  fixed F = m . d         varying V(x, y) = m . (q - a)
 * and at the point P(x, y) where the ray meets the plane N (forms F_N, V_N alike), with t = N . (a_N - o) / N . d,
 *   m . (P - a) = (F V_N - F_N V) / V_N  (perspective),  (V F_N - V_N F) / F_N  (orthographic).
 * Where t > 0 in perspective, V_N has the sign of -F_N; so in both cases
 *   sign m . (P - a) = sign(F V_N - F_N V) * -sign(F_N),
 * and G = F V_N - F_N V is linear in x and y: a shadow's edge on the receiver's plane is a straight line of the picture.
 *
 * Error, u = 2^-53. With M = sum of |p q| + |r s| over m's components (filter.h), W >= |o - a| or |d| and Q >= |q| or |q - a| in every
 * component over the whole picture, view_ray()'s own rounding included:
 *   m is off by 4u M in all; F by less than 8u M W; V(x, y), evaluated as v + x vx + y vy, by less than 4u M Q for m, u M Q for q - a,
 *   8u M Q for the rounding of q's own line and of view_ray(), 6u M Q for sums and products: less than 24u M Q.
 *   G by less than M W M_N Q_N (8u + 24u + 2u) + M_N W_N M Q (same): 34u of each; with G evaluated as g + x gx + y gy within a pixel
 *   8u more. LINE_ROUNDING = 128u covers V, F and G thrice over. */
#pragma once

#include "base/dmath.h"
#include "reference/exact.h"
#include "scene/view.h"

#define LINE_ROUNDING  0x1p-46 /* 128 u */
#define LINE_UNDERFLOW 1e-300

/* Vectors of this size are passed by reference to inlined functions only. */
#pragma GCC diagnostic ignored "-Wpsabi"

typedef double lane4 __attribute__((vector_size(32)));
typedef long long lane4_bits __attribute__((vector_size(32)));

/* Lanes: edges ab, bc, ca, then the plane N = (b - a) x (c - a). */
struct lines {
    lane4 fixed, v, vx, vy;   /* F; V(x, y) = v + x vx + y vy, x and y in pixels from the picture's corner */
    lane4 fixed_size, v_size; /* M W and M Q: times LINE_ROUNDING, what F and V are off at most */
};

/* The camera. */
struct screen {
    const struct view *view;
    struct dvec3 fixed;     /* o, or d */
    struct dvec3 q, qx, qy; /* q(x, y) = q + x qx + y qy */
    double size;            /* of q's largest component over the picture */
};

struct screen screen_make(const struct view *view);

static inline __attribute__((always_inline)) lane4 lane_abs(lane4 a) { return (lane4)((lane4_bits)a & 0x7fffffffffffffffLL); }

static inline __attribute__((always_inline)) lane4 lane_all(double x) { return (lane4){x, x, x, x}; }

/* A triangle's four forms seen from an apex. */
struct forms {
    lane4 x, y, z, size; /* m; M */
    lane4 ax, ay, az;    /* anchors: a, b, c, a */
};

static inline __attribute__((always_inline)) void forms_make(struct forms *f, const struct exact_apex *apex,
                                                             const struct dvec3 *a, const struct dvec3 *b, const struct dvec3 *c)
{
    f->ax = (lane4){a->x, b->x, c->x, a->x};
    f->ay = (lane4){a->y, b->y, c->y, a->y};
    f->az = (lane4){a->z, b->z, c->z, a->z};
    lane4 vx = (lane4){b->x, c->x, a->x, c->x} - f->ax;
    lane4 vy = (lane4){b->y, c->y, a->y, c->y} - f->ay;
    lane4 vz = (lane4){b->z, c->z, a->z, c->z} - f->az;
    const struct dvec3 *l = &apex->v;
    lane4 ux = (lane4){l->x, l->x, l->x, b->x}, uy = (lane4){l->y, l->y, l->y, b->y}, uz = (lane4){l->z, l->z, l->z, b->z};
    lane4 k = apex->infinite ? (lane4){0, 0, 0, 1} : (lane4){1, 1, 1, 1};
    ux -= f->ax * k, uy -= f->ay * k, uz -= f->az * k;
    lane4 p = uy * vz, q = uz * vy;
    f->x = p - q;
    f->size = lane_abs(p) + lane_abs(q);
    p = uz * vx, q = ux * vz;
    f->y = p - q;
    f->size += lane_abs(p) + lane_abs(q);
    p = ux * vy, q = uy * vx;
    f->z = p - q;
    f->size += lane_abs(p) + lane_abs(q);
}

static inline __attribute__((always_inline)) void lines_make(struct lines *out, const struct forms *f, const struct screen *s)
{
    const lane4 zero = {0, 0, 0, 0};
    bool flat = s->view->orthographic;
    lane4 ax = flat ? zero : f->ax, ay = flat ? zero : f->ay, az = flat ? zero : f->az;
    lane4 bx = flat ? f->ax : zero, by = flat ? f->ay : zero, bz = flat ? f->az : zero;
    lane4 x = s->fixed.x - ax, y = s->fixed.y - ay, z = s->fixed.z - az;
    out->fixed = f->x * x + f->y * y + f->z * z;
    out->fixed_size = f->size * (lane_abs(x) + lane_abs(y) + lane_abs(z));
    out->v = f->x * (s->q.x - bx) + f->y * (s->q.y - by) + f->z * (s->q.z - bz);
    out->vx = f->x * s->qx.x + f->y * s->qx.y + f->z * s->qx.z;
    out->vy = f->x * s->qy.x + f->y * s->qy.y + f->z * s->qy.z;
    out->v_size = f->size * (s->size + lane_abs(bx) + lane_abs(by) + lane_abs(bz));
}
