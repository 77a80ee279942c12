#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "members.h"

struct all {
    bool flag;
    uint64_t whole;
    double number, pair[2];
    const char *text;
    int choice;
    json_t *any;
};

static const char *const choices[] = {"red", "green", NULL};
static const struct member table[] = {
    {"flag", MEMBER_BOOL, offsetof(struct all, flag), .bit = 0},
    {"whole", MEMBER_INTEGER, offsetof(struct all, whole), 1, 10, .required = true, .bit = 1},
    {"number", MEMBER_NUMBER, offsetof(struct all, number), -1, 1, .bit = 2},
    {"pair", MEMBER_NUMBERS, offsetof(struct all, pair), 0, 5, .count = 2, .bit = 3},
    {"text", MEMBER_STRING, offsetof(struct all, text), .max = 4, .bit = 4},
    {"choice", MEMBER_CHOICE, offsetof(struct all, choice), .choices = choices, .bit = 5},
    {"any", MEMBER_ANY, offsetof(struct all, any), .bit = 6},
    {0},
};

static void test_reads_all(void **state)
{
    (void)state;
    struct all all = {0};
    struct given given;
    struct error err = {0};
    json_t *json = json_loads(
        "{\"flag\":true,\"whole\":7.0,\"number\":-0.5,\"pair\":[1,2.5],\"text\":\"abcd\",\"choice\":\"green\",\"any\":[]}", 0,
        NULL);
    assert_true(members_read(json, "", table, &all, &given, &err));
    assert_int_equal(given.bits, 0x7f);
    assert_true(all.flag);
    assert_int_equal(all.whole, 7);
    assert_true(all.number == -0.5 && all.pair[0] == 1 && all.pair[1] == 2.5);
    assert_string_equal(all.text, "abcd");
    assert_int_equal(all.choice, 1);
    assert_true(json_is_array(all.any));
    json_decref(json);
}

static void test_absent_members_stay(void **state)
{
    (void)state;
    struct all all = {.number = 0.25};
    struct given given;
    struct error err = {0};
    json_t *json = json_loads("{\"whole\":1}", 0, NULL);
    assert_true(members_read(json, "", table, &all, &given, &err));
    assert_int_equal(given.bits, 2);
    assert_true(all.number == 0.25);
    json_decref(json);
}

static void test_refusals(void **state)
{
    (void)state;
    static const struct {
        const char *json, *field, *text;
    } cases[] = {
        {"{\"whole\":1,\"flags\":1,\"nope\":2}", "at.flags", "at.flags, at.nope"},
        {"{}", "at.whole", "missing"},
        {"{\"whole\":0}", "at.whole", "1 to 10"},
        {"{\"whole\":11}", "at.whole", "1 to 10"},
        {"{\"whole\":1.5}", "at.whole", "integer"},
        {"{\"whole\":\"1\"}", "at.whole", "integer"},
        {"{\"whole\":true}", "at.whole", "integer"},
        {"{\"whole\":1,\"flag\":1}", "at.flag", "true or false"},
        {"{\"whole\":1,\"flag\":null}", "at.flag", "true or false"},
        {"{\"whole\":1,\"number\":1.01}", "at.number", "-1 to 1"},
        {"{\"whole\":1,\"pair\":[1]}", "at.pair", "2 numbers"},
        {"{\"whole\":1,\"pair\":[1,6]}", "at.pair", "0 to 5"},
        {"{\"whole\":1,\"pair\":[1,\"2\"]}", "at.pair", "2 numbers"},
        {"{\"whole\":1,\"text\":\"\"}", "at.text", "1 to 4"},
        {"{\"whole\":1,\"text\":\"abcde\"}", "at.text", "1 to 4"},
        {"{\"whole\":1,\"choice\":\"blue\"}", "at.choice", "red or green"},
        {"{\"whole\":1,\"choice\":0}", "at.choice", "red or green"},
        {"[1]", "at", "object"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct all all = {0};
        struct given given;
        struct error err = {0};
        json_t *json = json_loads(cases[i].json, 0, NULL);
        assert_non_null(json);
        assert_false(members_read(json, "at", table, &all, &given, &err));
        assert_int_equal(err.code, ERROR_USAGE);
        assert_string_equal(err.field, cases[i].field);
        assert_non_null(strstr(err.message, cases[i].text));
        json_decref(json);
    }
}

static void test_nothing_given(void **state)
{
    (void)state;
    static const struct member none[] = {{0}};
    struct all all;
    struct given given;
    struct error err = {0};
    assert_true(members_read(NULL, "", none, &all, &given, &err));
    assert_false(members_read(NULL, "", table, &all, &given, &err));
    assert_string_equal(err.field, "whole");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reads_all),
        cmocka_unit_test(test_absent_members_stay),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_nothing_given),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
