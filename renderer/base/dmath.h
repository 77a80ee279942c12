/* Double-precision vectors and affine maps, for positions whose error matters. cglm serves everything in single precision. */
#pragma once

#include <math.h>
#include <stdbool.h>

struct dvec3 {
    double x, y, z;
};

/* p' = linear * p + offset; rows. */
struct affine {
    double linear[3][3];
    double offset[3];
};

/* Closed box; empty when min > max in any axis. */
struct dbox {
    struct dvec3 min, max;
};

static inline struct dvec3 dvec3(double x, double y, double z) { return (struct dvec3){x, y, z}; }
static inline struct dvec3 dvec3_from_float(const float v[3]) { return (struct dvec3){v[0], v[1], v[2]}; }
static inline struct dvec3 dvec3_add(struct dvec3 a, struct dvec3 b) { return dvec3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline struct dvec3 dvec3_sub(struct dvec3 a, struct dvec3 b) { return dvec3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline struct dvec3 dvec3_scale(struct dvec3 a, double s) { return dvec3(a.x * s, a.y * s, a.z * s); }
static inline struct dvec3 dvec3_mad(struct dvec3 a, struct dvec3 b, double s)
{
    return dvec3(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}
static inline struct dvec3 dvec3_neg(struct dvec3 a) { return dvec3(-a.x, -a.y, -a.z); }
static inline double dvec3_dot(struct dvec3 a, struct dvec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline struct dvec3 dvec3_cross(struct dvec3 a, struct dvec3 b)
{
    return dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double dvec3_length(struct dvec3 a) { return sqrt(dvec3_dot(a, a)); }
/* A zero vector stays zero. */
static inline struct dvec3 dvec3_normalize(struct dvec3 a)
{
    double length = dvec3_length(a);
    return length > 0 ? dvec3_scale(a, 1 / length) : a;
}
static inline bool dvec3_finite(struct dvec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }

static inline struct affine affine_identity(void) { return (struct affine){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}}; }
static inline struct dvec3 affine_direction(const struct affine *a, struct dvec3 v)
{
    return dvec3(a->linear[0][0] * v.x + a->linear[0][1] * v.y + a->linear[0][2] * v.z,
                 a->linear[1][0] * v.x + a->linear[1][1] * v.y + a->linear[1][2] * v.z,
                 a->linear[2][0] * v.x + a->linear[2][1] * v.y + a->linear[2][2] * v.z);
}
static inline struct dvec3 affine_point(const struct affine *a, struct dvec3 p)
{
    struct dvec3 d = affine_direction(a, p);
    return dvec3(d.x + a->offset[0], d.y + a->offset[1], d.z + a->offset[2]);
}
/* Negative for a map that mirrors. */
static inline double affine_determinant(const struct affine *a)
{
    const double(*m)[3] = a->linear;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}
/* a after b: x -> a(b(x)). */
static inline struct affine affine_multiply(const struct affine *a, const struct affine *b)
{
    struct affine r;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            r.linear[i][j] =
                a->linear[i][0] * b->linear[0][j] + a->linear[i][1] * b->linear[1][j] + a->linear[i][2] * b->linear[2][j];
        r.offset[i] =
            a->linear[i][0] * b->offset[0] + a->linear[i][1] * b->offset[1] + a->linear[i][2] * b->offset[2] + a->offset[i];
    }
    return r;
}

static inline struct dbox dbox_empty(void)
{
    return (struct dbox){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}
static inline bool dbox_is_empty(const struct dbox *b)
{
    return !(b->min.x <= b->max.x && b->min.y <= b->max.y && b->min.z <= b->max.z);
}
static inline void dbox_add(struct dbox *b, struct dvec3 p)
{
    b->min = dvec3(fmin(b->min.x, p.x), fmin(b->min.y, p.y), fmin(b->min.z, p.z));
    b->max = dvec3(fmax(b->max.x, p.x), fmax(b->max.y, p.y), fmax(b->max.z, p.z));
}
static inline struct dvec3 dbox_center(const struct dbox *b) { return dvec3_scale(dvec3_add(b->min, b->max), 0.5); }
/* Half the diagonal; 0 for an empty box. */
static inline double dbox_radius(const struct dbox *b)
{
    return dbox_is_empty(b) ? 0 : 0.5 * dvec3_length(dvec3_sub(b->max, b->min));
}
