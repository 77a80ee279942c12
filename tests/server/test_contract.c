/* proto/gnomon.openrpc.json against the server's tables: the same methods, members, ranges and errors, in both directions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "dispatch.h"

static json_t *load(void)
{
    json_error_t where;
    json_t *document = json_load_file(SOURCE_DIR "/proto/gnomon.openrpc.json", JSON_REJECT_DUPLICATES, &where);
    if (!document)
        fail_msg("%s:%d: %s", where.source, where.line, where.text);
    return document;
}

static const json_t *named(const json_t *array, const char *name)
{
    size_t index;
    json_t *item;
    json_array_foreach((json_t *)array, index,
                       item) if (strcmp(json_string_value(json_object_get(item, "name")), name) == 0) return item;
    return NULL;
}

static size_t member_count(const struct member *table)
{
    size_t count = 0;
    while (table[count].name)
        count++;
    return count;
}

static void check_range(const struct member *m, const json_t *schema)
{
    const json_t *values = json_object_get(schema, "enum");
    if (m->kind == MEMBER_NUMBERS) {
        assert_int_equal(json_integer_value(json_object_get(schema, "minItems")), m->count);
        schema = json_object_get(schema, "items");
    }
    if ((m->kind == MEMBER_NUMBER || m->kind == MEMBER_INTEGER || m->kind == MEMBER_NUMBERS) && !values) {
        assert_true(json_number_value(json_object_get(schema, "minimum")) == m->min);
        assert_true(json_number_value(json_object_get(schema, "maximum")) == m->max);
    }
    if (m->kind != MEMBER_CHOICE)
        return;
    size_t count = 0;
    while (m->choices[count])
        count++;
    assert_int_equal(json_array_size(values), count);
    for (size_t i = 0; i < count; i++)
        assert_string_equal(json_string_value(json_array_get(values, i)), m->choices[i]);
}

static void test_methods(void **state)
{
    (void)state;
    json_t *document = load();
    const json_t *listed = json_object_get(document, "methods");
    size_t count = 0;
    for (; methods[count]; count++) {
        const json_t *method = named(listed, methods[count]->name);
        assert_non_null(method);
        const json_t *params = json_object_get(method, "params");
        assert_int_equal(json_array_size(params), member_count(methods[count]->members));
        for (const struct member *m = methods[count]->members; m->name; m++) {
            const json_t *param = named(params, m->name);
            if (!param)
                fail_msg("%s: %s is not in the document", methods[count]->name, m->name);
            assert_int_equal(json_is_true(json_object_get(param, "required")), m->required);
            check_range(m, json_object_get(param, "schema"));
        }
    }
    assert_int_equal(json_array_size(listed), count);
    json_decref(document);
}

/* The examples are requests that pass. */
static void test_examples(void **state)
{
    (void)state;
    json_t *document = load(), *method;
    size_t index;
    json_array_foreach(json_object_get(document, "methods"), index, method)
    {
        const struct method *m = method_find(json_string_value(json_object_get(method, "name")));
        assert_non_null(m);
        json_t *example, *param, *object = json_object();
        size_t i, j;
        json_array_foreach(json_object_get(method, "examples"), i, example)
            json_array_foreach(json_object_get(example, "params"), j, param)
                json_object_set(object, json_string_value(json_object_get(param, "name")), json_object_get(param, "value"));
        struct given given;
        struct error err = {0};
        void *params = calloc(1, m->params_size);
        if (!members_read(object, "", m->members, params, &given, &err))
            fail_msg("%s: %s", m->name, err.message);
        assert_true(given.bits != 0);
        free(params);
        json_decref(object);
    }
    json_decref(document);
}

static void test_errors(void **state)
{
    (void)state;
    static const enum error_code codes[] = {ERROR_DATA, ERROR_NO_INPUT, ERROR_NO_DEVICE, ERROR_IO, ERROR_TRY_AGAIN};
    json_t *document = load();
    const json_t *errors = json_object_get(json_object_get(document, "components"), "errors");
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {
        struct error err = {.code = codes[i], .message = "size: too much; 1 to 5 is accepted", .field = "size"};
        char key[16];
        snprintf(key, sizeof key, "%d", (int)dispatch_code(&err));
        assert_non_null(json_object_get(errors, key));
        json_t *told = dispatch_error_json(dispatch_code(&err), &err);
        const json_t *data = json_object_get(told, "data");
        assert_string_equal(json_string_value(json_object_get(data, "field")), "size");
        assert_string_equal(json_string_value(json_object_get(data, "limit")), "1 to 5 is accepted");
        json_decref(told);
    }
    json_decref(document);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_methods), cmocka_unit_test(test_examples),
                                       cmocka_unit_test(test_errors)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
