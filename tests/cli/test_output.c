#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/error.h"
#include "output.h"

static char folder[] = "/tmp/gnomon-output-XXXXXX";

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

static void in_folder(const char *name, char *out, size_t size) { snprintf(out, size, "%s/%s", folder, name); }

static void writes_json_and_a_newline(void **state)
{
    (void)state;
    char path[64], text[64] = "";
    in_folder("a.json", path, sizeof path);
    struct error err = {0};
    assert_true(output_json(path, json_pack("{s:f}", "tenth", 0.1), &err));
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    size_t length = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    unlink(path);
    text[length] = 0;
    assert_string_equal(text, "{\n  \"tenth\": 0.1\n}\n");
}

static void tells_a_full_disk(void **state)
{
    (void)state;
    struct error err = {0};
    if (access("/dev/full", W_OK) != 0)
        skip();
    assert_false(output_json("/dev/full", json_object(), &err));
    assert_int_equal(err.code, ERROR_IO);
    assert_non_null(strstr(err.message, "No space left"));
}

static void tells_a_missing_object(void **state)
{
    (void)state;
    struct error err = {0};
    assert_false(output_json("-", NULL, &err));
    assert_int_equal(err.code, ERROR_TRY_AGAIN);
}

static bool check(const char *path, enum error_code *code)
{
    struct error err = {0};
    bool good = output_check(path, &err);
    *code = err.code;
    return good;
}

static void checks_paths_before_the_work(void **state)
{
    (void)state;
    char path[64];
    enum error_code code;
    in_folder("new.json", path, sizeof path);
    assert_true(check(path, &code));
    assert_true(check("-", &code));
    assert_true(check("/dev/null", &code));
    assert_false(check(folder, &code));
    assert_int_equal(code, ERROR_IO);
    assert_false(check("/no/such/folder/a", &code));
    assert_int_equal(code, ERROR_IO);
    assert_false(check("", &code));
    assert_int_equal(code, ERROR_USAGE);
}

static void takes_any_bytes_as_text(void **state)
{
    (void)state;
    json_t *good = json_text("caf\xc3\xa9"), *cut = json_text("caf\xc3");
    assert_string_equal(json_string_value(good), "caf\xc3\xa9");
    assert_string_equal(json_string_value(cut), "caf?");
    json_decref(good);
    json_decref(cut);
}

static void has_null_for_what_json_cannot_say(void **state)
{
    (void)state;
    assert_true(json_is_null(json_number(NAN)));
    assert_true(json_is_null(json_number(INFINITY)));
    json_t *one = json_number(1);
    assert_true(json_is_real(one));
    json_decref(one);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_json_and_a_newline), cmocka_unit_test(tells_a_full_disk),
        cmocka_unit_test(tells_a_missing_object),    cmocka_unit_test(checks_paths_before_the_work),
        cmocka_unit_test(takes_any_bytes_as_text),   cmocka_unit_test(has_null_for_what_json_cannot_say),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
