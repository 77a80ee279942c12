/* Algorithm names and parameters as text, for every system of the registry. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "shadow/shadow.h"

static void refuse(const char *text, const char *expected)
{
    const struct shadow_system *system;
    struct shadow_params params;
    struct error err = {0};
    if (shadow_parse(text, &system, &params, &err))
        fail_msg("'%s' was accepted", text);
    assert_int_equal(err.code, ERROR_USAGE);
    assert_true(err.field[0] != 0);
    if (!strstr(err.message, expected))
        fail_msg("'%s' was refused with '%s', which does not say '%s'", text, err.message, expected);
}

static void accept(const char *text)
{
    const struct shadow_system *system;
    struct shadow_params params;
    struct error err = {0};
    if (!shadow_parse(text, &system, &params, &err))
        fail_msg("'%s' was refused: %s", text, err.message);
}

/* Names and descriptors that command line, wire and viewer can rely on. */
static void test_registry_is_sound(void **state)
{
    (void)state;
    for (size_t i = 0; i < shadow_system_count; i++) {
        const struct shadow_system *s = shadow_systems[i];
        assert_true(strlen(s->name) > 0 && strspn(s->name, "abcdefghijklmnopqrstuvwxyz0123456789_") == strlen(s->name));
        assert_true(shadow_find(s->name, strlen(s->name)) == s);
        assert_true(s->title[0] && s->help[0] && s->lights != 0 && s->resolve);
        assert_true(s->param_count <= SHADOW_PARAM_MAX);
        assert_true(!(s->flags & SHADOW_USES_MAPS) || shadow_param_index(s, "size") >= 0);
        for (size_t k = 0; k < s->param_count; k++) {
            const struct param_desc *p = &s->params[k];
            assert_true(strspn(p->name, "abcdefghijklmnopqrstuvwxyz_") == strlen(p->name));
            assert_true(p->help[0] && p->unit && p->min <= p->initial && p->initial <= p->max);
            assert_int_equal(shadow_param_index(s, p->name), k);
            for (int c = 0; p->kind == PARAM_CHOICE && c <= (int)p->max; c++)
                assert_non_null(p->choices[c]);
            if (p->kind == PARAM_CHOICE)
                assert_null(p->choices[(int)p->max + 1]);
        }
    }
    assert_true(shadow_find(shadow_default()->name, strlen(shadow_default()->name)) == shadow_default());
}

/* An unknown name is answered with every name there is. */
static void test_unknown_systems_list_the_known(void **state)
{
    (void)state;
    static const char *const wrong[] = {"", "nosuch", ":size=1", "nosuch:size=1024", " none", "none ", "NONE", ","};
    for (size_t w = 0; w < sizeof wrong / sizeof wrong[0]; w++)
        for (size_t i = 0; i < shadow_system_count; i++)
            refuse(wrong[w], shadow_systems[i]->name);
    char longest[3000];
    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = 0;
    refuse(longest, shadow_systems[0]->name);
}

static void refuse_pair(const struct shadow_system *s, const char *pair, const char *expected)
{
    char text[400];
    snprintf(text, sizeof text, "%s:%s", s->name, pair);
    refuse(text, expected);
}

static void test_wrong_pairs(void **state)
{
    (void)state;
    for (size_t i = 0; i < shadow_system_count; i++) {
        const struct shadow_system *s = shadow_systems[i];
        refuse_pair(s, "", "key=value");
        refuse_pair(s, "size", "key=value");
        refuse_pair(s, ",", "key=value");
        refuse_pair(s, "nosuch=1", s->param_count ? s->params[s->param_count - 1].name : "none");
        refuse_pair(s, "=1", s->param_count ? s->params[0].name : "none");
        char longest[300];
        memset(longest, '1', sizeof longest - 1);
        longest[sizeof longest - 1] = 0;
        refuse_pair(s, longest, "too long");
    }
}

static void refuse_value(const struct shadow_system *s, const struct param_desc *p, const char *value, const char *expected)
{
    char pair[200];
    snprintf(pair, sizeof pair, "%s=%s", p->name, value);
    refuse_pair(s, pair, expected);
}

static void check_number(const struct shadow_system *s, const struct param_desc *p)
{
    char least[40], most[40], text[80];
    snprintf(least, sizeof least, "%.9g", p->min);
    snprintf(most, sizeof most, "%.9g", p->max);
    static const char *const wrong[] = {"",   " ",  "abc",  "nan", "inf", "-inf", "1e999",
                                        "5x", "0x", "0x10", "--1", "1 2", " 17",  "17 "};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        refuse_value(s, p, wrong[i], least);
        refuse_value(s, p, wrong[i], most);
    }
    snprintf(text, sizeof text, "%.17g", p->max + (p->odd ? 2 : 1));
    refuse_value(s, p, text, most);
    snprintf(text, sizeof text, "%.17g", p->min - (p->odd ? 2 : 1));
    refuse_value(s, p, text, least);
    if (p->kind == PARAM_INT) {
        snprintf(text, sizeof text, "%.17g", p->min + 0.5);
        refuse_value(s, p, text, p->odd ? "odd number" : "whole number");
    }
    if (p->odd) {
        snprintf(text, sizeof text, "%.17g", p->min + 1);
        refuse_value(s, p, text, "odd number");
    }
    for (int end = 0; end < 2; end++) {
        snprintf(text, sizeof text, "%s:%s=%s", s->name, p->name, end ? most : least);
        accept(text);
    }
}

static void check_choice(const struct shadow_system *s, const struct param_desc *p)
{
    char text[120];
    for (int c = 0; p->choices[c]; c++) {
        refuse_value(s, p, "nosuch", p->choices[c]);
        refuse_value(s, p, "", p->choices[c]);
        snprintf(text, sizeof text, "%s:%s=%s", s->name, p->name, p->choices[c]);
        accept(text);
        snprintf(text, sizeof text, "%s ", p->choices[c]);
        refuse_value(s, p, text, p->choices[0]);
    }
}

static void test_wrong_values_are_told_the_range(void **state)
{
    (void)state;
    for (size_t i = 0; i < shadow_system_count; i++)
        for (size_t k = 0; k < shadow_systems[i]->param_count; k++) {
            const struct param_desc *p = &shadow_systems[i]->params[k];
            (p->kind == PARAM_CHOICE ? check_choice : check_number)(shadow_systems[i], p);
        }
}

static void check_round_trip(const struct shadow_system *s, const struct shadow_params *params)
{
    char text[256];
    const struct shadow_system *back;
    struct shadow_params values;
    struct error err = {0};
    shadow_format(s, params, text, sizeof text);
    if (!shadow_parse(text, &back, &values, &err))
        fail_msg("'%s': %s", text, err.message);
    assert_true(back == s);
    for (size_t k = 0; k < s->param_count; k++) {
        char key[80];
        snprintf(key, sizeof key, "%s=", s->params[k].name);
        assert_non_null(strstr(text, key));
        if (fabs(values.value[k] - params->value[k]) > 1e-8 * fabs(params->value[k]))
            fail_msg("'%s': %s comes back as %.17g, not %.17g", text, s->params[k].name, values.value[k], params->value[k]);
    }
}

static void test_format_round_trips(void **state)
{
    (void)state;
    for (size_t i = 0; i < shadow_system_count; i++) {
        const struct shadow_system *s = shadow_systems[i];
        struct shadow_params params = shadow_defaults(s);
        check_round_trip(s, &params);
        for (size_t k = 0; k < s->param_count; k++) {
            params.value[k] = s->params[k].max;
            check_round_trip(s, &params);
            params.value[k] = s->params[k].min;
            check_round_trip(s, &params);
            if (s->params[k].kind == PARAM_FLOAT)
                params.value[k] = s->params[k].min + (s->params[k].max - s->params[k].min) / 3;
            check_round_trip(s, &params);
        }
    }
}

/* A short buffer is ended, never run over. */
static void test_format_stays_in_its_buffer(void **state)
{
    (void)state;
    for (size_t i = 0; i < shadow_system_count; i++) {
        struct shadow_params params = shadow_defaults(shadow_systems[i]);
        for (size_t size = 1; size < 64; size++) {
            char *text = malloc(size);
            assert_non_null(text);
            shadow_format(shadow_systems[i], &params, text, size);
            assert_true(strlen(text) < size);
            free(text);
        }
    }
}

static void test_parameters_not_given_take_defaults(void **state)
{
    (void)state;
    const struct shadow_system *system;
    struct shadow_params params;
    struct error err = {0};
    assert_true(shadow_parse("sm:bias=0.5", &system, &params, &err));
    assert_true(params.value[shadow_param_index(system, "size")] == 1024);
    assert_true(params.value[shadow_param_index(system, "bias")] == 0.5);
    assert_true(shadow_parse("reference:samples=32,tracer=embree", &system, &params, &err));
    assert_true(params.value[0] == 1 && params.value[1] == 1);
    assert_true(shadow_parse("pcf:kernel=7,size=2048", &system, &params, &err));
    assert_true(params.value[shadow_param_index(system, "kernel")] == 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_registry_is_sound),
        cmocka_unit_test(test_unknown_systems_list_the_known),
        cmocka_unit_test(test_wrong_pairs),
        cmocka_unit_test(test_wrong_values_are_told_the_range),
        cmocka_unit_test(test_format_round_trips),
        cmocka_unit_test(test_format_stays_in_its_buffer),
        cmocka_unit_test(test_parameters_not_given_take_defaults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
