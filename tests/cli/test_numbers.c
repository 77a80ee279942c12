#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "numbers.h"

static void takes_decimal_numbers(void **state)
{
    (void)state;
    double v;
    assert_true(number_parse("1.5", 0, 2, &v) && v == 1.5);
    assert_true(number_parse("-2e1", -100, 0, &v) && v == -20);
    assert_true(number_parse(".5", 0, 1, &v) && v == 0.5);
    assert_true(number_parse("+1", 0, 1, &v) && v == 1);
}

static void refuses_what_is_not_all_number(void **state)
{
    (void)state;
    static const char *const bad[] = {"", " 1", "1 ", "1px", "0x10", "inf", "nan", "-inf", "1e999", "--1", ".", "e5", "1,2"};
    double v = 42;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_false(number_parse(bad[i], -1e300, 1e300, &v));
    assert_false(number_parse("3", 0, 2, &v));
    assert_true(v == 42);
}

static void reads_unsigned_numbers(void **state)
{
    (void)state;
    unsigned long n;
    assert_true(number_parse_unsigned("16", 1, 16, &n) && n == 16);
    assert_false(number_parse_unsigned("17", 1, 16, &n));
    assert_false(number_parse_unsigned("0", 1, 16, &n));
    assert_false(number_parse_unsigned("-1", 0, 16, &n));
    assert_false(number_parse_unsigned("+1", 0, 16, &n));
    assert_false(number_parse_unsigned("", 0, 16, &n));
    assert_false(number_parse_unsigned("99999999999999999999999", 0, (unsigned long)-1, &n));
}

static void reads_sizes(void **state)
{
    (void)state;
    uint32_t w, h;
    struct error err = {0};
    assert_true(number_parse_size("1280x720", 16384, &w, &h, &err));
    assert_int_equal(w, 1280);
    assert_int_equal(h, 720);
    assert_true(number_parse_size("1x16384", 16384, &w, &h, &err));
    static const char *const bad[] = {"",      "x",     "1280",     "1280x",        "x720",
                                      "0x1",   "1x0",   "16385x1",  "1x16385",      "-1x1",
                                      "1 x 1", "1x1x1", "1280X720", "4294967297x1", "00000000000000000000000000000000000001x1"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct error e = {0};
        assert_false(number_parse_size(bad[i], 16384, &w, &h, &e));
        assert_int_equal(e.code, ERROR_USAGE);
        assert_non_null(strstr(e.message, "16384"));
    }
}

static void reads_points(void **state)
{
    (void)state;
    struct dvec3 p;
    struct error err = {0};
    assert_true(number_parse_point("1,-2.5,1e7", &p, &err));
    assert_true(p.x == 1 && p.y == -2.5 && p.z == 1e7);
    static const char *const bad[] = {"", "1,2", "1,2,3,4", "1,2,", "1;2;3", "1,2,nan", "1,2,3 ", ",,"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct error e = {0};
        assert_false(number_parse_point(bad[i], &p, &e));
        assert_int_equal(e.code, ERROR_USAGE);
    }
}

static void lists_names(void **state)
{
    (void)state;
    static const char *const names[] = {"a", "b", "c", NULL};
    char text[32], small[6];
    name_list(names, text, sizeof text);
    assert_string_equal(text, "a, b or c");
    name_list(names, small, sizeof small);
    assert_string_equal(small, "a, b ");
    assert_int_equal(name_index(names, "c"), 2);
    assert_int_equal(name_index(names, "d"), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(takes_decimal_numbers),  cmocka_unit_test(refuses_what_is_not_all_number),
        cmocka_unit_test(reads_unsigned_numbers), cmocka_unit_test(reads_sizes),
        cmocka_unit_test(reads_points),           cmocka_unit_test(lists_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
