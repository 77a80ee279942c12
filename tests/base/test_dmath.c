#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/dmath.h"

static void assert_vector(struct dvec3 v, double x, double y, double z)
{
    assert_true(fabs(v.x - x) < 1e-12 && fabs(v.y - y) < 1e-12 && fabs(v.z - z) < 1e-12);
}

static void vectors(void **state)
{
    (void)state;
    struct dvec3 a = dvec3(1, 2, 3), b = dvec3(-4, 5, 0.5);
    assert_vector(dvec3_add(a, b), -3, 7, 3.5);
    assert_vector(dvec3_sub(a, b), 5, -3, 2.5);
    assert_vector(dvec3_mad(a, b, 2), -7, 12, 4);
    assert_vector(dvec3_neg(a), -1, -2, -3);
    assert_true(dvec3_dot(a, b) == 7.5);
    assert_vector(dvec3_cross(dvec3(1, 0, 0), dvec3(0, 1, 0)), 0, 0, 1);
    assert_true(dvec3_dot(dvec3_cross(a, b), a) == 0);
    assert_true(dvec3_length(dvec3(2, 3, 6)) == 7);
    assert_vector(dvec3_from_float((float[]){0.5f, -1, 2}), 0.5, -1, 2);
}

static void normalize_keeps_zero(void **state)
{
    (void)state;
    assert_vector(dvec3_normalize(dvec3(0, 0, 0)), 0, 0, 0);
    assert_vector(dvec3_normalize(dvec3(0, -3, 4)), 0, -0.6, 0.8);
}

static void finite_sees_each_part(void **state)
{
    (void)state;
    assert_true(dvec3_finite(dvec3(1e308, -1e308, 0)));
    assert_false(dvec3_finite(dvec3(NAN, 0, 0)));
    assert_false(dvec3_finite(dvec3(0, INFINITY, 0)));
    assert_false(dvec3_finite(dvec3(0, 0, -INFINITY)));
}

/* 90 degrees about z, then a shift. */
static const struct affine quarter = {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}, {10, 20, 30}};
static const struct affine stretch = {{{2, 0, 0}, {0, 3, 0}, {0, 0, -1}}, {1, 1, 1}};

static void maps(void **state)
{
    (void)state;
    struct affine id = affine_identity();
    assert_vector(affine_point(&id, dvec3(1, 2, 3)), 1, 2, 3);
    assert_vector(affine_point(&quarter, dvec3(1, 2, 3)), 8, 21, 33);
    assert_vector(affine_direction(&quarter, dvec3(1, 2, 3)), -2, 1, 3);
    assert_true(affine_determinant(&quarter) == 1);
    assert_true(affine_determinant(&stretch) == -6);
}

static void products_apply_right_to_left(void **state)
{
    (void)state;
    struct affine both = affine_multiply(&quarter, &stretch);
    struct dvec3 p = dvec3(0.25, -1, 4), step = affine_point(&stretch, p), wanted = affine_point(&quarter, step);
    assert_vector(affine_point(&both, p), wanted.x, wanted.y, wanted.z);
    assert_true(fabs(affine_determinant(&both) + 6) < 1e-12);
}

static void boxes(void **state)
{
    (void)state;
    struct dbox box = dbox_empty();
    assert_true(dbox_is_empty(&box));
    assert_true(dbox_radius(&box) == 0);
    dbox_add(&box, dvec3(1, 1, 1));
    assert_false(dbox_is_empty(&box));
    assert_true(dbox_radius(&box) == 0);
    dbox_add(&box, dvec3(-1, 3, 0));
    assert_vector(box.min, -1, 1, 0);
    assert_vector(box.max, 1, 3, 1);
    assert_vector(dbox_center(&box), 0, 2, 0.5);
    assert_true(dbox_radius(&box) == 1.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vectors), cmocka_unit_test(normalize_keeps_zero),         cmocka_unit_test(finite_sees_each_part),
        cmocka_unit_test(maps),    cmocka_unit_test(products_apply_right_to_left), cmocka_unit_test(boxes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
