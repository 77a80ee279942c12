#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/array.h"

static void push_keeps_values(void **state)
{
    (void)state;
    ARRAY(uint32_t) a = {0};
    for (uint32_t i = 0; i < 100000; i++)
        assert_true(array_push(&a, i * 7));
    assert_int_equal(a.count, 100000);
    assert_true(a.capacity >= a.count);
    for (uint32_t i = 0; i < 100000; i++)
        assert_int_equal(a.data[i], i * 7);
    array_finish(&a);
    assert_null(a.data);
    assert_int_equal(a.count, 0);
    assert_int_equal(a.capacity, 0);
}

static void extend_makes_room(void **state)
{
    (void)state;
    ARRAY(double) a = {0};
    assert_true(array_extend(&a, 3));
    assert_int_equal(a.count, 3);
    a.data[2] = 5;
    assert_true(array_extend(&a, 1000));
    assert_int_equal(a.count, 1003);
    assert_true(a.data[2] == 5);
    array_finish(&a);
}

static void reserve_leaves_the_count(void **state)
{
    (void)state;
    ARRAY(char) a = {0};
    assert_true(array_reserve(&a, 5000));
    assert_int_equal(a.count, 0);
    assert_true(a.capacity >= 5000);
    char *before = a.data;
    for (int i = 0; i < 5000; i++)
        assert_true(array_push(&a, 'x'));
    assert_ptr_equal(a.data, before);
    array_finish(&a);
}

/* Sizes that would wrap are refused, and the array stays as it was. */
static void absurd_sizes_are_refused(void **state)
{
    (void)state;
    ARRAY(uint64_t) a = {0};
    assert_true(array_push(&a, 42));
    assert_false(array_reserve(&a, SIZE_MAX));
    assert_false(array_reserve(&a, SIZE_MAX / 8));
    assert_false(array_extend(&a, SIZE_MAX - 1));
    assert_int_equal(a.count, 1);
    assert_int_equal(a.data[0], 42);
    array_finish(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(push_keeps_values),
        cmocka_unit_test(extend_makes_room),
        cmocka_unit_test(reserve_leaves_the_count),
        cmocka_unit_test(absurd_sizes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
