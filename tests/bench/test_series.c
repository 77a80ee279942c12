#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bench/series.h"

static void quartiles_of_known_values(void **state)
{
    (void)state;
    const double odd[] = {5, 1, 4, 2, 3}, even[] = {4, 1, 3, 2};
    struct series s = series_of(odd, 5);
    assert_int_equal(s.count, 5);
    assert_true(s.min == 1 && s.q1 == 2 && s.median == 3 && s.q3 == 4 && s.max == 5);
    s = series_of(even, 4);
    assert_true(s.q1 == 1.75 && s.median == 2.5 && s.q3 == 3.25);
    const double one[] = {7};
    s = series_of(one, 1);
    assert_true(s.min == 7 && s.q1 == 7 && s.median == 7 && s.q3 == 7 && s.max == 7);
}

static void what_was_not_measured_does_not_count(void **state)
{
    (void)state;
    const double values[] = {NAN, 2, NAN, 4, 6};
    struct series s = series_of(values, 5);
    assert_int_equal(s.count, 3);
    assert_true(s.median == 4);
    assert_int_equal(series_of(values, 1).count, 0);
    assert_true(isnan(series_of(values, 1).median));
    assert_true(isnan(series_of(NULL, 0).median));
}

/* The machine is three times slower in the second half: medians of each lie, the ratio does not. */
static void ratios_pair_what_was_measured_together(void **state)
{
    (void)state;
    const double a[] = {11, 22, 33, 66, NAN}, b[] = {10, 20, 30, 60, 1};
    struct series s = series_of_ratios(a, b, 5);
    assert_int_equal(s.count, 4);
    assert_true(fabs(s.median - 1.1) < 1e-12 && fabs(s.min - 1.1) < 1e-12 && fabs(s.max - 1.1) < 1e-12);
    const double zero[] = {0, 0};
    assert_int_equal(series_of_ratios(a, zero, 2).count, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quartiles_of_known_values),
        cmocka_unit_test(what_was_not_measured_does_not_count),
        cmocka_unit_test(ratios_pair_what_was_measured_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
