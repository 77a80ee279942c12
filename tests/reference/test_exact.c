/* Predicates by themselves: known answers, symmetry, and the certified filter against them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "reference/exact.h"
#include "reference/filter.h"

static double drawn(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / 16777216.0 * 2 - 1;
}

static struct dvec3 drawn_point(uint32_t *seed)
{
    double x = drawn(seed), y = drawn(seed);
    return dvec3(x, y, drawn(seed));
}

static const struct dvec3 flat[3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

static void sides_of_a_plane(void **state)
{
    (void)state;
    const struct exact_point above = {.kind = EXACT_POINT, .v = {1e9, -7, 0x1p-1000}},
                             in = {.kind = EXACT_POINT, .v = {1e300, 3, 0}};
    assert_int_equal(exact_plane_side(&above, flat), 1);
    assert_int_equal(exact_plane_side(&in, flat), 0);
    assert_int_equal(exact_apex_side(&(struct exact_apex){true, {1, 1, -1e-300}}, flat), -1);
    assert_int_equal(exact_apex_side(&(struct exact_apex){true, {1, 1, 0}}, flat), 0);
    assert_int_equal(exact_apex_side(&(struct exact_apex){false, {1, 1, 2}}, flat), 1);
}

/* The point where (1/3, ...) is not a double: exactly on a plane through it all the same. */
static void a_point_on_a_plane_is_on_it(void **state)
{
    (void)state;
    const struct exact_point p = {.kind = EXACT_ON_PLANE,
                                  .ray_origin = {0.1, 0.2, 5},
                                  .ray_direction = {0.3, 0.7, -3},
                                  .plane = {{0, 0, 0.1}, {4, 0, 0.3}, {0, 4, 0.7}}};
    const struct dvec3 shifted[3] = {{4, 0, 0.3}, {0, 4, 0.7}, {0, 0, 0.1}};
    assert_int_equal(exact_plane_side(&p, p.plane), 0);
    assert_int_equal(exact_plane_side(&p, shifted), 0);
    struct dvec3 q = exact_round_point(&p);
    double t = (q.z - 5) / -3;
    assert_true(fabs(q.x - (0.1 + 0.3 * t)) < 1e-15 && fabs(q.y - (0.2 + 0.7 * t)) < 1e-15);
}

static void depths_compare(void **state)
{
    (void)state;
    const struct dvec3 o = {0, 0, 3}, d = {0.1, 0.1, -1};
    const struct dvec3 turned[3] = {{4, 0, 0}, {0, 0, 0}, {0, 4, 0}};
    struct dvec3 higher[3] = {flat[0], flat[1], flat[2]};
    for (int i = 0; i < 3; i++)
        higher[i].z = 0x1p-1000;
    assert_int_equal(exact_compare_depths(o, d, flat, turned), 0);
    assert_int_equal(exact_compare_depths(o, d, higher, flat), -1);
    assert_int_equal(exact_compare_depths(o, d, turned, higher), 1);
    assert_int_equal(exact_compare_depth(o, d, turned, 3), 0);
    assert_int_equal(exact_compare_depth(o, d, flat, nextafter(3, 4)), -1);
    assert_int_equal(exact_compare_depth(o, d, flat, -1e-300), 1);
    assert_int_equal(exact_compare_depth(o, d, flat, 0), 1);
}

/* Ties: the line goes through the vertex that all blades of a fan share. It must cross exactly one of them. */
static void one_blade_of_a_fan_is_crossed(void **state)
{
    (void)state;
    static const struct dvec3 ring[6] = {{2, 0, 0}, {1, 2, 1}, {-1, 2, 0}, {-2, 0, -1}, {-1, -2, 0}, {1, -2, 1}};
    const struct dvec3 hub = {0, 0, 0};
    const struct exact_apex apexes[] = {{false, {0, 0, 8}}, {false, {2, 2, 8}}, {true, {0, 0, 1}}, {true, {1, -1, 4}}};
    for (size_t k = 0; k < sizeof apexes / sizeof apexes[0]; k++) {
        struct exact_point p = {.kind = EXACT_POINT, .v = dvec3_scale(apexes[k].v, -1)};
        int crossed = 0;
        for (int i = 0; i < 6; i++) {
            struct dvec3 a = ring[i], b = ring[(i + 1) % 6];
            int first = exact_edge_side(&apexes[k], &p, hub, a), second = exact_edge_side(&apexes[k], &p, a, b);
            int third = exact_edge_side(&apexes[k], &p, b, hub);
            assert_int_equal(exact_edge_side(&apexes[k], &p, a, hub), -first);
            assert_int_equal(exact_edge_side(&apexes[k], &p, b, a), -second);
            crossed += first != 0 && first == second && second == third;
        }
        assert_int_equal(crossed, 1);
    }
}

/* Lanes near and on the edge, off by a few units in the last place: what the filter says must be so, and the two ways it is computed agree. */
static void the_filter_is_never_wrong(void **state)
{
    (void)state;
    uint32_t seed = 3;
    size_t decided = 0, undecided = 0;
    for (int round = 0; round < 200; round++) {
        struct dvec3 a = drawn_point(&seed), b = drawn_point(&seed), light = dvec3_scale(drawn_point(&seed), 10);
        const struct exact_apex apex = {round % 2, light};
        struct form form = form_edge(&apex, false, a, b);
        struct lanes lanes;
        for (int i = 0; i < LANES; i++) {
            struct dvec3 on = dvec3_mad(a, dvec3_sub(b, a), drawn(&seed));
            on = dvec3_mad(on, apex.infinite ? light : dvec3_sub(light, on), drawn(&seed));
            on.x += ldexp(drawn(&seed), i % 8 == 0 ? -1100 : -56 + i);
            lanes.x[i] = on.x;
            lanes.y[i] = on.y;
            lanes.z[i] = on.z;
            lanes.error[i] = 0;
        }
        unsigned positive, negative;
        filter_signs(&form, &lanes, &positive, &negative);
        assert_int_equal(positive & negative, 0);
        for (int i = 0; i < LANES; i++) {
            const struct exact_point p = {.kind = EXACT_POINT, .v = {lanes.x[i], lanes.y[i], lanes.z[i]}};
            double error, value = form_value(&form, p.v, 0, &error);
            int sign = (int)(positive >> i & 1) - (int)(negative >> i & 1);
            assert_int_equal(sign, value > error ? 1 : value < -error ? -1 : 0);
            if (sign != 0)
                assert_int_equal(sign, exact_edge_side(&apex, &p, a, b));
            decided += sign != 0;
            undecided += sign == 0;
        }
    }
    assert_true(decided > 500 && undecided > 500);
}

static void depth_bounds_hold(void **state)
{
    (void)state;
    uint32_t seed = 9;
    for (int round = 0; round < 500; round++) {
        struct dvec3 triangle[3] = {drawn_point(&seed), drawn_point(&seed), drawn_point(&seed)};
        struct dvec3 origin = dvec3_scale(drawn_point(&seed), 5), direction = drawn_point(&seed);
        if (round % 2) /* nearly parallel */
            direction = dvec3_mad(dvec3_sub(triangle[1], triangle[0]), direction, 1e-13);
        struct form plane = form_plane(triangle);
        double error, t = form_depth(&plane, origin, direction, &error);
        if (!isfinite(error))
            continue;
        assert_true(exact_compare_depth(origin, direction, triangle, t - error * (1 + 1e-9)) >= 0);
        assert_true(exact_compare_depth(origin, direction, triangle, t + error * (1 + 1e-9)) <= 0);
        assert_true(round % 2 || error < 1e-6 * (1 + fabs(t) * fabs(t)));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sides_of_a_plane),
        cmocka_unit_test(a_point_on_a_plane_is_on_it),
        cmocka_unit_test(depths_compare),
        cmocka_unit_test(one_blade_of_a_fan_is_crossed),
        cmocka_unit_test(the_filter_is_never_wrong),
        cmocka_unit_test(depth_bounds_hold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
