#include "reference/exact.h"

#include <assert.h>
#include <gmp.h>
#include <math.h>
#include <stdint.h>

typedef mpz_t zvec[3];

/* Inputs as integers: value = integer * 2^exponent. */
enum { INPUTS_MAX = 39 };
struct inputs {
    mpz_t z[INPUTS_MAX];
    unsigned count;
    long exponent;
};

/* x = mantissa * 2^*exponent with an odd mantissa, or 0. */
static int64_t split(double x, int *exponent)
{
    assert(isfinite(x));
    if (x == 0)
        return 0;
    int64_t mantissa = (int64_t)ldexp(frexp(x, exponent), 53);
    int zeros = __builtin_ctzll((unsigned long long)mantissa);
    *exponent += zeros - 53;
    return mantissa / ((int64_t)1 << zeros);
}

static void inputs_init(struct inputs *in, const struct dvec3 *vectors, unsigned count)
{
    const double *x = &vectors[0].x;
    int64_t mantissa[INPUTS_MAX];
    int exponent[INPUTS_MAX] = {0}, least = INT16_MAX;
    in->count = 3 * count;
    assert(in->count <= INPUTS_MAX);
    for (unsigned i = 0; i < in->count; i++) {
        mantissa[i] = split(x[i], &exponent[i]);
        if (mantissa[i] && exponent[i] < least)
            least = exponent[i];
    }
    in->exponent = least == INT16_MAX ? 0 : least;
    for (unsigned i = 0; i < in->count; i++) {
        mpz_init_set_si(in->z[i], mantissa[i]);
        if (mantissa[i])
            mpz_mul_2exp(in->z[i], in->z[i], (mp_bitcnt_t)(exponent[i] - least));
    }
}

static void inputs_finish(struct inputs *in)
{
    for (unsigned i = 0; i < in->count; i++)
        mpz_clear(in->z[i]);
}

static void zvec_init(zvec v)
{
    for (int i = 0; i < 3; i++)
        mpz_init(v[i]);
}

static void zvec_finish(zvec v)
{
    for (int i = 0; i < 3; i++)
        mpz_clear(v[i]);
}

static void zvec_sub(zvec r, mpz_t *a, mpz_t *b)
{
    for (int i = 0; i < 3; i++)
        mpz_sub(r[i], a[i], b[i]);
}

static void zvec_cross(zvec r, mpz_t *a, mpz_t *b)
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpz_mul(r[i], a[j], b[k]);
        mpz_submul(r[i], a[k], b[j]);
    }
}

static void zvec_dot(mpz_t r, mpz_t *a, mpz_t *b)
{
    mpz_mul(r, a[0], b[0]);
    mpz_addmul(r, a[1], b[1]);
    mpz_addmul(r, a[2], b[2]);
}

static void zvec_normal(zvec r, mpz_t *triangle)
{
    zvec u, v;
    zvec_init(u);
    zvec_init(v);
    zvec_sub(u, triangle + 3, triangle);
    zvec_sub(v, triangle + 6, triangle);
    zvec_cross(r, u, v);
    zvec_finish(v);
    zvec_finish(u);
}

/* Depth of the triangle's plane on a ray as numerator / denominator. */
static void depth_fraction(mpz_t numerator, mpz_t denominator, mpz_t *origin, mpz_t *direction, mpz_t *triangle)
{
    zvec n, to;
    zvec_init(n);
    zvec_init(to);
    zvec_normal(n, triangle);
    zvec_sub(to, triangle, origin);
    zvec_dot(numerator, n, to);
    zvec_dot(denominator, n, direction);
    zvec_finish(to);
    zvec_finish(n);
}

/* A point as v / w with w > 0, or a direction with w = 0. */
struct homogeneous {
    zvec v;
    mpz_t w;
};

static unsigned point_vectors(const struct exact_point *p, struct dvec3 *out)
{
    if (p->kind != EXACT_ON_PLANE) {
        out[0] = p->v;
        return 1;
    }
    out[0] = p->ray_origin;
    out[1] = p->ray_direction;
    for (int i = 0; i < 3; i++)
        out[2 + i] = p->plane[i];
    return 5;
}

/* `in` as point_vectors() put them. */
static void homogeneous_init(struct homogeneous *h, const struct exact_point *p, mpz_t *in)
{
    zvec_init(h->v);
    mpz_init(h->w);
    if (p->kind != EXACT_ON_PLANE) {
        mpz_set_si(h->w, p->kind == EXACT_POINT);
        for (int i = 0; i < 3; i++)
            mpz_set(h->v[i], in[i]);
        return;
    }
    mpz_t t;
    mpz_init(t);
    depth_fraction(t, h->w, in, in + 3, in + 6);
    assert(mpz_sgn(h->w) != 0);
    if (mpz_sgn(h->w) < 0) {
        mpz_neg(h->w, h->w);
        mpz_neg(t, t);
    }
    for (int i = 0; i < 3; i++) {
        mpz_mul(h->v[i], in[i], h->w);
        mpz_addmul(h->v[i], in[3 + i], t);
    }
    mpz_clear(t);
}

static void homogeneous_finish(struct homogeneous *h)
{
    mpz_clear(h->w);
    zvec_finish(h->v);
}

/* Sign of m . (p - a). */
static int side(mpz_t *m, const struct homogeneous *p, mpz_t *a)
{
    mpz_t sum, difference;
    mpz_init(sum);
    mpz_init(difference);
    for (int i = 0; i < 3; i++) {
        mpz_set(difference, p->v[i]);
        mpz_submul(difference, a[i], p->w);
        mpz_addmul(sum, m[i], difference);
    }
    int sign = mpz_sgn(sum);
    mpz_clear(difference);
    mpz_clear(sum);
    return sign;
}

int exact_edge_side(const struct exact_apex *apex, const struct exact_point *p, struct dvec3 a, struct dvec3 b)
{
    struct dvec3 vectors[8] = {apex->v, a, b};
    struct inputs in;
    struct homogeneous h;
    zvec edge, to, m;
    inputs_init(&in, vectors, 3 + point_vectors(p, vectors + 3));
    homogeneous_init(&h, p, in.z + 9);
    zvec_init(edge);
    zvec_init(to);
    zvec_init(m);

    zvec_sub(edge, in.z + 6, in.z + 3);
    zvec_sub(to, in.z, in.z + 3);
    zvec_cross(m, apex->infinite ? in.z : to, edge);
    int sign = side(m, &h, in.z + 3);
    for (int i = 0; i < 3 && sign == 0; i++)
        sign = mpz_sgn(m[i]);

    zvec_finish(m);
    zvec_finish(to);
    zvec_finish(edge);
    homogeneous_finish(&h);
    inputs_finish(&in);
    return sign;
}

int exact_plane_side(const struct exact_point *p, const struct dvec3 triangle[3])
{
    struct dvec3 vectors[8] = {triangle[0], triangle[1], triangle[2]};
    struct inputs in;
    struct homogeneous h;
    zvec n;
    inputs_init(&in, vectors, 3 + point_vectors(p, vectors + 3));
    homogeneous_init(&h, p, in.z + 9);
    zvec_init(n);
    zvec_normal(n, in.z);
    int sign = side(n, &h, in.z);
    zvec_finish(n);
    homogeneous_finish(&h);
    inputs_finish(&in);
    return sign;
}

int exact_apex_side(const struct exact_apex *apex, const struct dvec3 triangle[3])
{
    struct exact_point p = {.kind = apex->infinite ? EXACT_DIRECTION : EXACT_POINT, .v = apex->v};
    return exact_plane_side(&p, triangle);
}

int exact_compare_depths(struct dvec3 origin, struct dvec3 direction, const struct dvec3 first[3], const struct dvec3 second[3])
{
    const struct dvec3 vectors[8] = {origin, direction, first[0], first[1], first[2], second[0], second[1], second[2]};
    struct inputs in;
    mpz_t n1, d1, n2, d2;
    inputs_init(&in, vectors, 8);
    mpz_inits(n1, d1, n2, d2, NULL);
    depth_fraction(n1, d1, in.z, in.z + 3, in.z + 6);
    depth_fraction(n2, d2, in.z, in.z + 3, in.z + 15);
    int signs = mpz_sgn(d1) * mpz_sgn(d2);
    mpz_mul(n1, n1, d2);
    mpz_submul(n1, n2, d1);
    signs *= mpz_sgn(n1);
    mpz_clears(n1, d1, n2, d2, NULL);
    inputs_finish(&in);
    return signs;
}

int exact_compare_depth(struct dvec3 origin, struct dvec3 direction, const struct dvec3 triangle[3], double depth)
{
    const struct dvec3 vectors[5] = {origin, direction, triangle[0], triangle[1], triangle[2]};
    struct inputs in;
    mpz_t n, d, t;
    int exponent = 0;
    inputs_init(&in, vectors, 5);
    mpz_inits(n, d, NULL);
    mpz_init_set_si(t, split(depth, &exponent));
    depth_fraction(n, d, in.z, in.z + 3, in.z + 6);
    int sign = mpz_sgn(d);
    mpz_mul(t, t, d);
    mpz_mul_2exp(exponent < 0 ? n : t, exponent < 0 ? n : t, (mp_bitcnt_t)(exponent < 0 ? -exponent : exponent));
    sign *= mpz_cmp(n, t) > 0 ? 1 : mpz_cmp(n, t) < 0 ? -1 : 0;
    mpz_clears(n, d, t, NULL);
    inputs_finish(&in);
    return sign;
}

struct dvec3 exact_round_point(const struct exact_point *p)
{
    struct dvec3 vectors[5], result;
    struct inputs in;
    struct homogeneous h;
    mpq_t q;
    inputs_init(&in, vectors, point_vectors(p, vectors));
    homogeneous_init(&h, p, in.z);
    mpq_init(q);
    double *out = &result.x;
    for (int i = 0; i < 3; i++) {
        mpz_set(mpq_numref(q), h.v[i]);
        mpz_set(mpq_denref(q), h.w);
        mpq_canonicalize(q);
        out[i] = ldexp(mpq_get_d(q), (int)in.exponent);
    }
    mpq_clear(q);
    homogeneous_finish(&h);
    inputs_finish(&in);
    return result;
}
