/* view_ray() and view_project() undo each other; the 32 samples. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "made_scene.h"

static struct view tilted(bool orthographic)
{
    struct camera c = made_camera(dvec3(3, 2, 5), dvec3(0.5, 0.25, -1), 0.9);
    c.orthographic = orthographic;
    c.ymag = 2.5;
    return view_from_camera(&c, 640, 360);
}

static void round_trip(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        struct view v = tilted(kind == 1);
        for (int i = 0; i < 200; i++) {
            double x = 3.2 * i, y = 359 - 1.79 * i, depth = 0.5 + i, px, py, pd;
            struct dvec3 origin, direction;
            view_ray(&v, x, y, &origin, &direction);
            assert_true(fabs(dvec3_dot(direction, v.forward) - 1) < 1e-12);
            assert_true(view_project(&v, dvec3_mad(origin, direction, depth), &px, &py, &pd));
            assert_true(fabs(px - x) < 1e-9 && fabs(py - y) < 1e-9 && fabs(pd - depth) < 1e-11);
        }
    }
}

static void edges_are_where_the_angle_says(void **state)
{
    (void)state;
    struct view v = tilted(false);
    struct dvec3 origin, direction;
    view_ray(&v, 320, 0, &origin, &direction);
    double angle = atan2(dvec3_dot(direction, v.up), dvec3_dot(direction, v.forward));
    assert_true(fabs(angle - 0.45) < 1e-12);
    view_ray(&v, 640, 180, &origin, &direction);
    assert_true(fabs(dvec3_dot(direction, v.right) - tan(0.45) * 640 / 360) < 1e-12);
    assert_true(fabs(dvec3_dot(direction, v.up)) < 1e-12);
    v = tilted(true);
    view_ray(&v, 0, 0, &origin, &direction);
    assert_true(fabs(dvec3_dot(dvec3_sub(origin, v.eye), v.up) - 2.5) < 1e-12);
}

static void behind_the_eye_is_refused(void **state)
{
    (void)state;
    double x = 7, y = 7, depth = 7;
    struct view v = tilted(false);
    assert_false(view_project(&v, dvec3_mad(v.eye, v.forward, -1), &x, &y, &depth));
    assert_false(view_project(&v, v.eye, &x, &y, &depth));
    assert_true(x == 7 && y == 7 && depth == 7);
    v = tilted(true);
    assert_true(view_project(&v, dvec3_mad(v.eye, v.forward, -1), &x, &y, &depth));
    assert_true(depth < 0);
}

static double torus(double a, double b)
{
    double d = fabs(a - b);
    return d < 0.5 ? d : 1 - d;
}

static void samples_are_latin_and_spread(void **state)
{
    (void)state;
    uint32_t columns = 0, rows = 0;
    for (int i = 0; i < 32; i++) {
        double x = (double)view_samples32[i][0] * 64, y = (double)view_samples32[i][1] * 64;
        assert_true(x == floor(x) && y == floor(y) && (int)x % 2 == 1 && (int)y % 2 == 1 && x < 64 && y < 64);
        columns |= 1u << (int)x / 2;
        rows |= 1u << (int)y / 2;
        for (int k = 0; k < i; k++) {
            double dx = torus((double)view_samples32[i][0], (double)view_samples32[k][0]);
            double dy = torus((double)view_samples32[i][1], (double)view_samples32[k][1]);
            assert_true(dx * dx + dy * dy >= 26.0 / 1024);
        }
    }
    assert_int_equal(columns, UINT32_MAX);
    assert_int_equal(rows, UINT32_MAX);
}

static void parallel_far_is_pulled_to_the_scene(void **state)
{
    (void)state;
    struct dbox bounds = {dvec3(-1, -1, -1), dvec3(1, 1, 1)}, nothing = dbox_empty();
    struct view v = tilted(true);
    double center = -dvec3_dot(v.eye, v.forward), ends[] = {INFINITY, 1e30, 1e9};
    for (int i = 0; i < 3; i++) {
        v.far = ends[i];
        view_limit_far(&v, &bounds);
        assert_true(v.far > center + sqrt(3) && v.far < center + 2);
    }
    v.far = center;
    view_limit_far(&v, &bounds);
    assert_true(v.far == center);
    v.near = 100; /* all of it before the near plane */
    v.far = INFINITY;
    view_limit_far(&v, &bounds);
    assert_true(v.far > v.near && v.far < 110);
    v.far = INFINITY;
    view_limit_far(&v, &nothing);
    assert_true(v.far > v.near && isfinite(v.far));
    v = tilted(false);
    v.far = INFINITY;
    view_limit_far(&v, &bounds);
    assert_true(isinf(v.far));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(round_trip),
        cmocka_unit_test(edges_are_where_the_angle_says),
        cmocka_unit_test(behind_the_eye_is_refused),
        cmocka_unit_test(samples_are_latin_and_spread),
        cmocka_unit_test(parallel_far_is_pulled_to_the_scene),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
