/* Conservative rasterization (shadow/geometry/conservative.h) against an exhaustive exact overlap test: no touched texel is ever missed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/lanes.h"
#include "shadow/geometry/conservative.h"

#define SIDE 32

static uint32_t seed = 1;

static double random_unit(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) * 0x1p-24;
}

/* Corners are floats and texel borders whole numbers, so that differences, products and the sums of two products are exact in quad precision
 * as far as these ranges go: the separating axes of a triangle and a closed square are the square's sides and the triangle's edges. */
typedef __float128 quad;

static bool separated_by_edge(const quad x[3], const quad y[3], int k, quad u, quad v)
{
    int j = (k + 1) % 3, o = (k + 2) % 3;
    quad a = y[k] - y[j], b = x[j] - x[k];
    quad other = a * (x[o] - x[k]) + b * (y[o] - y[k]), most = 0, least = 0;
    for (int corner = 0; corner < 4; corner++) {
        quad e = a * (u + (corner & 1) - x[k]) + b * (v + (corner >> 1) - y[k]);
        most = corner == 0 || e > most ? e : most;
        least = corner == 0 || e < least ? e : least;
    }
    return other >= 0 ? most < 0 || least > other : least > 0 || most < other;
}

static bool truly_touches(const float px[3], const float py[3], int u, int v)
{
    quad x[3], y[3];
    for (int k = 0; k < 3; k++) {
        x[k] = px[k];
        y[k] = py[k];
    }
    if ((x[0] < u && x[1] < u && x[2] < u) || (x[0] > u + 1 && x[1] > u + 1 && x[2] > u + 1) ||
        (y[0] < v && y[1] < v && y[2] < v) || (y[0] > v + 1 && y[1] > v + 1 && y[2] > v + 1))
        return false;
    for (int k = 0; k < 3; k++)
        if (separated_by_edge(x, y, k, u, v))
            return false;
    return true;
}

struct tally {
    size_t touched, missed, extra, far; /* far: extra, and not within two margins of being touched */
};

/* Grown by two margins: what may be marked beside what must be. Corner regions may stretch: bounded by the box alone. */
static bool nearly_touches(const float px[3], const float py[3], int u, int v)
{
    const double m = 2 * CONSERVATIVE_MARGIN;
    double x[3], y[3], area;
    for (int k = 0; k < 3; k++) {
        x[k] = px[k];
        y[k] = py[k];
    }
    area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    for (int k = 0; k < 3; k++) {
        int j = (k + 1) % 3;
        double turn = area < 0 ? -1 : 1, a = turn * (y[k] - y[j]), b = turn * (x[j] - x[k]);
        double e = a * (u + 0.5 - x[k]) + b * (v + 0.5 - y[k]);
        if (e < -(0.5 + m) * (fabs(a) + fabs(b)))
            return false;
    }
    return true;
}

static void check(const float x[3], const float y[3], bool forgets_margin, struct tally *t)
{
    struct conservative c;
    bool any = conservative_setup(&c, x, y, SIDE, SIDE);
    for (int k = 0; any && forgets_margin && k < 3; k++)
        c.reach[k] = 0; /* as plain rasterization does: centres only */
    for (int v = 0; v < SIDE; v++)
        for (int u = 0; u < SIDE; u += LANES) {
            unsigned bits = any ? conservative_row(&c, u, v) : 0;
            for (int i = 0; i < LANES; i++) {
                bool truth = truly_touches(x, y, u + i, v), marked = bits >> i & 1;
                t->touched += truth;
                t->missed += truth && !marked;
                t->extra += marked && !truth;
                t->far += marked && !truth && !nearly_touches(x, y, u + i, v);
            }
        }
}

static void fill_near(float x[3], float y[3], double size, double spread)
{
    double cx = spread * (random_unit() - 0.5) + SIDE / 2, cy = spread * (random_unit() - 0.5) + SIDE / 2;
    for (int k = 0; k < 3; k++) {
        x[k] = (float)(cx + size * (random_unit() - 0.5));
        y[k] = (float)(cy + size * (random_unit() - 0.5));
    }
}

static void expect_none_missed(const struct tally *t)
{
    assert_true(t->touched > 1000);
    assert_int_equal(t->missed, 0);
    assert_int_equal(t->far, 0);
}

static void test_random_triangles(void **state)
{
    (void)state;
    static const double sizes[] = {0.01, 0.5, 2, 10, 60, 1000, 16384};
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        struct tally t = {0};
        for (int i = 0; i < (sizes[s] < 5 ? 2000 : 200); i++) {
            float x[3], y[3];
            fill_near(x, y, sizes[s], SIDE);
            check(x, y, false, &t);
        }
        expect_none_missed(&t);
    }
}

static void test_slivers(void **state)
{
    (void)state;
    struct tally t = {0};
    for (int i = 0; i < 400; i++) {
        float x[3], y[3];
        fill_near(x, y, i % 2 ? 60 : 16384, SIDE);
        double w = random_unit(), off = 1e-6 * (random_unit() - 0.5);
        x[2] = (float)(x[0] + w * (x[1] - x[0]) + off);
        y[2] = (float)(y[0] + w * (y[1] - y[0]) - off);
        check(x, y, false, &t);
    }
    expect_none_missed(&t);
}

/* On whole and half numbers everything lies exactly on borders and centres; two or three corners may be one. */
static void test_degenerate_and_on_borders(void **state)
{
    (void)state;
    struct tally t = {0};
    for (int i = 0; i < 2000; i++) {
        float x[3], y[3];
        for (int k = 0; k < 3; k++) {
            x[k] = (float)((int)(80 * random_unit()) - 8) / 2;
            y[k] = (float)((int)(80 * random_unit()) - 8) / 2;
        }
        if (i % 3 == 1)
            x[2] = x[1], y[2] = y[1];
        if (i % 9 == 2)
            x[0] = x[1] = x[2], y[0] = y[1] = y[2];
        check(x, y, false, &t);
    }
    expect_none_missed(&t);
}

/* The comparison can fail: rasterizing centres alone misses plenty. */
static void test_centres_alone_miss(void **state)
{
    (void)state;
    struct tally t = {0};
    for (int i = 0; i < 50; i++) {
        float x[3], y[3];
        fill_near(x, y, 5, SIDE);
        check(x, y, true, &t);
    }
    assert_true(t.missed > 100);
}

static void test_one_texel_agrees_with_rows(void **state)
{
    (void)state;
    for (int i = 0; i < 300; i++) {
        float x[3], y[3];
        fill_near(x, y, 6, SIDE);
        for (int v = 0; v < SIDE; v++)
            for (int u = 0; u < SIDE; u++)
                if (truly_touches(x, y, u, v))
                    assert_true(conservative_touches(x, y, (float)u, (float)v));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_triangles),           cmocka_unit_test(test_slivers),
        cmocka_unit_test(test_degenerate_and_on_borders),  cmocka_unit_test(test_centres_alone_miss),
        cmocka_unit_test(test_one_texel_agrees_with_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
