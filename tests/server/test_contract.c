/* What proto/gnomon.openrpc.json says against what C has lists and limits of its own for. The tables themselves are made from it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "cameras.h"
#include "common_options.h"
#include "answer.h"
#include "dispatch.h"
#include "output.h"
#include "server.h"

static const struct member *param(const char *method, const char *name)
{
    const struct method *m = method_find(method);
    assert_non_null(m);
    for (const struct member *p = m->members; p->name; p++)
        if (strcmp(p->name, name) == 0)
            return p;
    fail_msg("%s has no %s", method, name);
    return NULL;
}

/* The index of a choice is the value of an enum: the same words in the same order. */
static void assert_choices(const struct member *m, const char *const *names, size_t count)
{
    assert_int_equal(m->kind, MEMBER_CHOICE);
    for (size_t i = 0; i < count; i++)
        assert_string_equal(m->choices[i], names[i]);
    assert_null(m->choices[count]);
}

static size_t length(const char *const *names)
{
    size_t count = 0;
    while (names[count])
        count++;
    return count;
}

static void test_choices(void **state)
{
    (void)state;
    static const char *const streaming[] = {METHOD_VIEW_OPEN, METHOD_VIEW_SET};
    static const char *const showing[] = {METHOD_VIEW_OPEN, METHOD_VIEW_SET, METHOD_RENDER_SNAPSHOT};
    for (size_t i = 0; i < 2; i++)
        assert_choices(param(streaming[i], "codec"), codec_names, GNMF_WEBP + 1);
    for (size_t i = 0; i < 3; i++) {
        assert_choices(param(showing[i], "show"), show_names, length(show_names));
        assert_choices(param(showing[i], "tonemap"), tonemap_names, length(tonemap_names));
    }
    assert_choices(param(METHOD_RENDER_SNAPSHOT, "format"), codec_names, GNMF_EXR + 1);
}

static void test_limits(void **state)
{
    (void)state;
    assert_true(param(METHOD_VIEW_OPEN, "size")->max == SERVER_STREAM_SIDE_MAX);
    assert_true(param(METHOD_VIEW_SET, "size")->max == SERVER_STREAM_SIDE_MAX);
    assert_true(param(METHOD_RENDER_SNAPSHOT, "size")->max == RENDERER_SIZE_MAX);
    assert_true(param(METHOD_LIGHT_SET, "index")->max == RENDERER_LIGHTS_MAX - 1);
    assert_true(param(METHOD_SCENE_LOAD, "scene")->max == SCENE_NAME_MAX - 1);
    assert_true(look_at_members[LOOK_AT_FOV].min == FOV_MIN_DEG && look_at_members[LOOK_AT_FOV].max == FOV_MAX_DEG);
}

/* No two parameters of a method share a bit, and none reaches past struct given. */
static void test_bits(void **state)
{
    (void)state;
    for (const struct method *m = methods; m->name; m++) {
        uint64_t seen = 0;
        for (const struct member *p = m->members; p->name; p++) {
            assert_true(p->bit < 64 && !(seen >> p->bit & 1));
            assert_true(p->offset < sizeof(struct params));
            seen |= 1ull << p->bit;
        }
    }
}

static void test_errors(void **state)
{
    (void)state;
    static const enum error_code codes[] = {ERROR_DATA, ERROR_NO_INPUT, ERROR_NO_DEVICE, ERROR_IO, ERROR_TRY_AGAIN, ERROR_BUG};
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {
        struct error err = {.code = codes[i], .message = "size: too much; 1 to 5 is accepted", .field = "size"};
        json_t *told = rpc_error_json(rpc_code_of(&err), &err);
        const json_t *data = json_object_get(told, "data");
        assert_string_equal(json_string_value(json_object_get(data, "field")), "size");
        assert_string_equal(json_string_value(json_object_get(data, "limit")), "1 to 5 is accepted");
        json_decref(told);
    }
    for (const struct protocol_error *e = protocol_errors; e->code; e++)
        assert_true(e->http >= 400 && e->http < 600);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_choices), cmocka_unit_test(test_limits), cmocka_unit_test(test_bits),
                                       cmocka_unit_test(test_errors)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
