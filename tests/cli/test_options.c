#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "common_options.h"

struct own {
    const char *output;
    bool flag;
};

static bool set_output(void *target, const char *value, struct error *err)
{
    if (!strcmp(value, "bad"))
        return error_set(err, ERROR_USAGE, "o", "is bad; good is accepted");
    ((struct own *)target)->output = value;
    return true;
}

static bool set_flag(void *target, const char *value, struct error *err)
{
    (void)err;
    assert_null(value);
    ((struct own *)target)->flag = true;
    return true;
}

static const struct option table[] = {
    {"o", "FILE", "where to", set_output}, {"flag", NULL, "a flag", set_flag}, {"later", "X", "not yet", NULL}, {0}};
static const struct syntax syntax = {.command = "try",
                                     .usage = "SCENE [options]",
                                     .summary = "Tries.",
                                     .operand = "SCENE",
                                     .common = true,
                                     .options = table,
                                     .examples = "  gnomon try x\n"};

struct attempt {
    struct own own;
    struct common_options common;
    const char *operand;
    struct error err;
    enum parsed result;
};

static struct attempt parse_words(const char *const *words)
{
    struct attempt a = {0};
    char *argv[40] = {(char *)(uintptr_t) "try"};
    int argc = 1;
    while (*words)
        argv[argc++] = (char *)(uintptr_t)*words++;
    common_options_init(&a.common);
    a.result = options_parse(&syntax, argc, argv, &a.own, &a.common, &a.operand, &a.err);
    return a;
}

#define parse(...) parse_words((const char *const[]){__VA_ARGS__, NULL})

static void reads_options_in_any_order(void **state)
{
    (void)state;
    struct attempt a = parse("--size", "32x16", "scene.glb", "-o", "-", "--flag", "--exposure=-2.5");
    assert_int_equal(a.result, PARSED_RUN);
    assert_string_equal(a.operand, "scene.glb");
    assert_string_equal(a.own.output, "-");
    assert_true(a.own.flag);
    assert_int_equal(a.common.width, 32);
    assert_int_equal(a.common.height, 16);
    assert_false(a.common.exposure_auto);
    assert_true(a.common.exposure_ev == -2.5);
}

static void takes_values_that_begin_with_a_dash(void **state)
{
    (void)state;
    struct attempt a = parse("x", "--exposure", "-3", "--eye", "-1,2,3", "--target", "-1,0,-3");
    assert_int_equal(a.result, PARSED_RUN);
    assert_true(a.common.exposure_ev == -3 && a.common.camera.eye.x == -1);
    assert_int_equal(a.common.camera.source, CAMERA_LOOK_AT);
}

static void has_the_contracts_defaults(void **state)
{
    (void)state;
    struct attempt a = parse("x");
    assert_int_equal(a.result, PARSED_RUN);
    assert_true(a.common.exposure_auto && a.common.ambient == 0.03 && a.common.aa == 1 && a.common.tonemap == TONEMAP_ACES);
    assert_int_equal(a.common.camera.source, CAMERA_FIRST);
    assert_int_equal(a.common.light_count, 0);
    assert_true(a.common.threads >= 1);
    assert_null(a.common.system);
}

static void two_dashes_end_the_options(void **state)
{
    (void)state;
    struct attempt a = parse("--flag", "--", "--size");
    assert_int_equal(a.result, PARSED_RUN);
    assert_string_equal(a.operand, "--size");
}

static void collects_lights(void **state)
{
    (void)state;
    struct attempt a = parse("x", "--light", "point position=1,2,3", "--light", "spot");
    assert_int_equal(a.result, PARSED_RUN);
    assert_int_equal(a.common.light_count, 2);
    assert_int_equal(a.common.lights[1].kind, LIGHT_SPOT);
    const char *words[2 * RENDERER_LIGHTS_MAX + 4] = {"x"};
    for (int i = 0; i < 2 * (RENDERER_LIGHTS_MAX + 1); i++)
        words[1 + i] = i % 2 ? "point" : "--light";
    a = parse_words(words);
    assert_int_equal(a.result, PARSED_BAD);
    assert_non_null(strstr(a.err.message, "at most 16"));
}

static void help_wins(void **state)
{
    (void)state;
    assert_int_equal(parse("--help").result, PARSED_HELP);
    assert_int_equal(parse("--size", "bad", "-h").result, PARSED_HELP);
}

static void refuses(const char *says, struct attempt a)
{
    assert_int_equal(a.result, PARSED_BAD);
    assert_int_equal(a.err.code, ERROR_USAGE);
    if (!strstr(a.err.message, says))
        fail_msg("'%s' is not in: %s", says, a.err.message);
}

static void says_what_it_would_take(void **state)
{
    (void)state;
    refuses("needs an argument", parse("--flag"));
    refuses("one SCENE", parse("a", "b"));
    refuses("accepted: -o --flag --size", parse("x", "--siez", "1x1"));
    refuses("no option -x", parse("x", "-x"));
    refuses("no option --o", parse("x", "--o", "f"));
    refuses("no option -size", parse("x", "-size", "1x1"));
    refuses("--size needs a value: --size WxH", parse("x", "--size"));
    refuses("--size needs a value", parse("x", "--size", "--flag"));
    refuses("takes no value", parse("x", "--flag=1"));
    refuses("-o 'bad': is bad; good is accepted", parse("x", "-o", "bad"));
    refuses("try --later is not built yet", parse("x", "--later", "1"));
    refuses("--time is not built yet", parse("x", "--time", "1"));
    refuses("1 to 1048576 MiB", parse("x", "--memory=-5"));
    refuses("SCENE is empty", parse(""));
}

static void names_the_range_of_every_value(void **state)
{
    (void)state;
    refuses("1 to 16384", parse("x", "--size", "0x5"));
    refuses("0.01 to 179 degrees", parse("x", "--fov", "180"));
    refuses("scene units", parse("x", "--ortho", "0"));
    refuses("x,y,z", parse("x", "--eye", "1,2"));
    refuses("shaded, visibility, depth, normal, id or difference", parse("x", "--show", "wire"));
    refuses("auto or -64 to 64", parse("x", "--exposure", "65"));
    refuses("0 to", parse("x", "--ambient", "-1"));
    refuses("aces or none", parse("x", "--tonemap", "ACES"));
    refuses("1, 4 or 16", parse("x", "--aa", "2"));
    refuses("auto, raster or traced", parse("x", "--camera-pass", "x"));
    refuses("1 to 100000 frames", parse("x", "--frames-timed", "0"));
    refuses("1 to 256 threads", parse("x", "--threads", "257"));
    refuses("error, warning, info or debug", parse("x", "--log-level", "loud"));
    refuses("gnomon list devices", parse("x", "--device", ""));
}

static void refuses_what_does_not_go_together(void **state)
{
    (void)state;
    refuses("belong together", parse("x", "--eye", "1,2,3"));
    refuses("belong together", parse("x", "--target", "1,2,3"));
    refuses("exclude each other", parse("x", "--eye", "1,2,3", "--target", "0,0,0", "--camera", "0"));
    refuses("--fov is accepted only with", parse("x", "--fov", "40"));
    refuses("--ortho is accepted only with", parse("x", "--ortho", "2"));
    refuses("and without --fov", parse("x", "--eye", "1,2,3", "--target", "0,0,0", "--ortho", "2", "--fov", "40"));
    refuses("--up is accepted only with", parse("x", "--up", "0,1,0"));
    refuses("two different points", parse("x", "--eye", "1,2,3", "--target", "1,2,3"));
}

static void help_lists_every_option_and_what_is_missing(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    options_print_help(&syntax, out);
    fclose(out);
    for (const struct option *o = common_option_table; o->name; o++) {
        char name[40];
        snprintf(name, sizeof name, "  --%s ", o->name);
        assert_non_null(strstr(text, name));
    }
    assert_non_null(strstr(text, "not yet (not built yet)"));
    assert_non_null(strstr(text, "Examples:\n  gnomon try x\n"));
    free(text);
}

static void threads_follow_slurm(void **state)
{
    (void)state;
    setenv("SLURM_CPUS_PER_TASK", "7", 1);
    assert_int_equal(threads_allowed(), 7);
    setenv("SLURM_CPUS_PER_TASK", "no number", 1);
    assert_in_range(threads_allowed(), 1, THREADS_MAX);
    unsetenv("SLURM_CPUS_PER_TASK");
    assert_in_range(threads_allowed(), 1, THREADS_MAX);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_options_in_any_order),
        cmocka_unit_test(takes_values_that_begin_with_a_dash),
        cmocka_unit_test(has_the_contracts_defaults),
        cmocka_unit_test(two_dashes_end_the_options),
        cmocka_unit_test(collects_lights),
        cmocka_unit_test(help_wins),
        cmocka_unit_test(says_what_it_would_take),
        cmocka_unit_test(names_the_range_of_every_value),
        cmocka_unit_test(refuses_what_does_not_go_together),
        cmocka_unit_test(help_lists_every_option_and_what_is_missing),
        cmocka_unit_test(threads_follow_slurm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
