#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"

static void first_error_wins(void **state)
{
    (void)state;
    struct error err = {0};
    assert_false(error_set(&err, ERROR_DATA, "size", "the file has %d bytes", 3));
    assert_false(error_set(&err, ERROR_IO, "other", "later"));
    assert_int_equal(err.code, ERROR_DATA);
    assert_string_equal(err.message, "the file has 3 bytes");
    assert_string_equal(err.field, "size");
}

static void field_may_be_missing(void **state)
{
    (void)state;
    struct error err = {0};
    error_set(&err, ERROR_USAGE, NULL, "no");
    assert_string_equal(err.field, "");
}

static void control_characters_are_replaced(void **state)
{
    (void)state;
    struct error err = {0};
    error_set(&err, ERROR_DATA, "a\nb", "line%sbell\a tab\t del\x7f end", "\r\n");
    assert_string_equal(err.message, "line??bell? tab? del? end");
    assert_string_equal(err.field, "a?b");
}

/* `glyph` repeated past the capacity, after `shift` bytes that move the cut: whole glyphs only may remain. */
static void check_cut(const char *glyph, size_t shift)
{
    struct error err = {0};
    char text[1024] = "";
    memset(text, 'x', shift);
    while (strlen(text) + strlen(glyph) < sizeof text - 1)
        strcat(text, glyph);
    error_set(&err, ERROR_DATA, NULL, "%s", text);
    size_t length = strlen(err.message);
    assert_true(length < sizeof err.message);
    assert_true(length + strlen(glyph) >= sizeof err.message);
    assert_int_equal((length - shift) % strlen(glyph), 0);
    assert_memory_equal(err.message, text, length);
}

static void long_text_is_cut_at_a_character(void **state)
{
    (void)state;
    static const char *const glyphs[] = {"a", "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x8c\x92"};
    for (size_t g = 0; g < sizeof glyphs / sizeof glyphs[0]; g++)
        for (size_t shift = 0; shift < 8; shift++)
            check_cut(glyphs[g], shift);
}

static void prefix_goes_in_front(void **state)
{
    (void)state;
    struct error err = {0};
    error_set(&err, ERROR_DATA, "count", "too many");
    assert_false(error_prefix(&err, "mesh %d", 4));
    assert_string_equal(err.message, "mesh 4: too many");
    assert_int_equal(err.code, ERROR_DATA);
    assert_string_equal(err.field, "count");
}

static void long_prefix_is_cut(void **state)
{
    (void)state;
    struct error err = {0};
    char text[2000];
    memset(text, 'p', sizeof text - 1);
    text[sizeof text - 1] = 0;
    error_set(&err, ERROR_DATA, NULL, "tail");
    error_prefix(&err, "%s", text);
    assert_int_equal(strlen(err.message), sizeof err.message - 1);
    assert_null(strchr(err.message, 't'));
}

/* The contract's exit codes. */
static void codes_are_exit_codes(void **state)
{
    (void)state;
    assert_int_equal(ERROR_USAGE, 64);
    assert_int_equal(ERROR_DATA, 65);
    assert_int_equal(ERROR_NO_INPUT, 66);
    assert_int_equal(ERROR_NO_DEVICE, 69);
    assert_int_equal(ERROR_BUG, 70);
    assert_int_equal(ERROR_IO, 74);
    assert_int_equal(ERROR_TRY_AGAIN, 75);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(first_error_wins),
        cmocka_unit_test(field_may_be_missing),
        cmocka_unit_test(control_characters_are_replaced),
        cmocka_unit_test(long_text_is_cut_at_a_character),
        cmocka_unit_test(prefix_goes_in_front),
        cmocka_unit_test(long_prefix_is_cut),
        cmocka_unit_test(codes_are_exit_codes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
