#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bench/front.h"

enum { POINTS = 7 };

static const struct front_point points[POINTS] = {
    {1, 10},  /* cheapest */
    {2, 5},   /* between */
    {2, 7},   /* beaten by the one before */
    {4, 0},   /* best */
    {4, 0},   /* its equal */
    {5, 0},   /* as good, dearer */
    {NAN, 1}, /* not measured */
};
static const bool expected[POINTS] = {true, true, false, true, true, false, false};

/* Whether a marking is the front, by its definition and not by how front_mark() finds it. */
static bool is_front(const bool *marked)
{
    for (size_t i = 0; i < POINTS; i++) {
        bool beaten = isnan(points[i].cost) || isnan(points[i].error);
        for (size_t k = 0; k < POINTS; k++)
            beaten |= points[k].cost <= points[i].cost && points[k].error <= points[i].error &&
                      (points[k].cost < points[i].cost || points[k].error < points[i].error);
        if (marked[i] == beaten)
            return false;
    }
    return true;
}

static void marks_what_nothing_beats(void **state)
{
    (void)state;
    bool on_front[POINTS];
    front_mark(points, POINTS, on_front);
    assert_memory_equal(on_front, expected, sizeof expected);
    assert_true(is_front(on_front));
}

static void a_wrong_front_is_found_out(void **state)
{
    (void)state;
    bool wrong[POINTS];
    for (size_t flip = 0; flip < POINTS; flip++) {
        for (size_t i = 0; i < POINTS; i++)
            wrong[i] = i == flip ? !expected[i] : expected[i];
        assert_false(is_front(wrong));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marks_what_nothing_beats),
        cmocka_unit_test(a_wrong_front_is_found_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
