#include "members.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "numbers.h"

struct member_path {
    char text[64];
};

static struct member_path path_of(const char *where, const char *name)
{
    struct member_path path;
    snprintf(path.text, sizeof path.text, "%s%s%s", where, *where ? "." : "", name);
    return path;
}

static const struct member *find(const struct member *table, const char *name)
{
    for (; table->name; table++)
        if (strcmp(table->name, name) == 0)
            return table;
    return NULL;
}

static void append(char *list, size_t size, const char *word)
{
    size_t used = strlen(list);
    snprintf(list + used, size - used, "%s%s", used ? ", " : "", word);
}

static bool refuse_unknown(const json_t *object, const char *where, const struct member *table, struct error *err)
{
    char unknown[160] = "", known[240] = "";
    const char *key;
    json_t *value;
    struct member_path first = {""};
    json_object_foreach((json_t *)object, key, value)
    {
        if (find(table, key))
            continue;
        if (!first.text[0])
            first = path_of(where, key);
        append(unknown, sizeof unknown, path_of(where, key).text);
    }
    if (!first.text[0])
        return true;
    for (const struct member *m = table; m->name; m++)
        append(known, sizeof known, m->name);
    return error_set(err, ERROR_USAGE, first.text, "unknown member%s %s; accepted: %s", strstr(unknown, ", ") ? "s" : "", unknown,
                     known[0] ? known : "none");
}

static bool in_range(const struct member *m, const json_t *value)
{
    if (!json_is_number(value))
        return false;
    double x = json_number_value(value);
    return x >= m->min && x <= m->max;
}

static bool read_number(const struct member *m, const json_t *value, void *field, const char *name, struct error *err)
{
    if (!in_range(m, value))
        return error_set(err, ERROR_USAGE, name, "%s: a number is wanted; %.15g to %.15g is accepted", name, m->min, m->max);
    *(double *)field = json_number_value(value);
    return true;
}

static bool read_listed(const struct member *m, const json_t *value, void *field, const char *name, struct error *err)
{
    char list[120] = "";
    for (const double *v = m->values; *v != 0; v++) {
        if (json_is_number(value) && json_number_value(value) == *v) {
            *(uint64_t *)field = (uint64_t)*v;
            return true;
        }
        char word[32];
        snprintf(word, sizeof word, "%.0f", *v);
        append(list, sizeof list, word);
    }
    return error_set(err, ERROR_USAGE, name, "%s: no such choice; one of %s is accepted", name, list);
}

/* 5.0 is an integer too: JSON does not tell them apart. */
static bool read_integer(const struct member *m, const json_t *value, void *field, const char *name, struct error *err)
{
    if (m->values)
        return read_listed(m, value, field, name, err);
    if (!in_range(m, value) || floor(json_number_value(value)) != json_number_value(value))
        return error_set(err, ERROR_USAGE, name, "%s: an integer is wanted; %.0f to %.0f is accepted", name, m->min, m->max);
    *(uint64_t *)field = (uint64_t)json_number_value(value);
    return true;
}

static bool read_string(const struct member *m, const json_t *value, void *field, const char *name, struct error *err)
{
    if (!json_is_string(value) || json_string_length(value) == 0 || (double)json_string_length(value) > m->max)
        return error_set(err, ERROR_USAGE, name, "%s: a string is wanted; 1 to %.0f bytes are accepted", name, m->max);
    *(const char **)field = json_string_value(value);
    return true;
}

static bool read_choice(const struct member *m, const json_t *value, void *field, const char *name, struct error *err)
{
    int index = json_is_string(value) ? name_index(m->choices, json_string_value(value)) : -1;
    if (index < 0) {
        char list[160];
        name_list(m->choices, list, sizeof list);
        return error_set(err, ERROR_USAGE, name, "%s: no such choice; %s is accepted", name, list);
    }
    *(int *)field = index;
    return true;
}

static bool read_numbers(const struct member *m, const json_t *value, void *field, const char *name, struct error *err)
{
    bool good = json_is_array(value) && json_array_size(value) == m->count;
    for (size_t i = 0; good && i < m->count; i++)
        good = in_range(m, json_array_get(value, i));
    if (!good)
        return error_set(err, ERROR_USAGE, name, "%s: an array of %zu numbers is wanted; %.15g to %.15g each is accepted", name,
                         m->count, m->min, m->max);
    for (size_t i = 0; i < m->count; i++)
        ((double *)field)[i] = json_number_value(json_array_get(value, i));
    return true;
}

static bool read_member(const struct member *m, json_t *value, void *field, const char *name, struct error *err)
{
    switch (m->kind) {
    case MEMBER_BOOL:
        *(bool *)field = json_is_true(value);
        return json_is_boolean(value) ||
               error_set(err, ERROR_USAGE, name, "%s: a boolean is wanted; true or false is accepted", name);
    case MEMBER_INTEGER: return read_integer(m, value, field, name, err);
    case MEMBER_NUMBER: return read_number(m, value, field, name, err);
    case MEMBER_STRING: return read_string(m, value, field, name, err);
    case MEMBER_CHOICE: return read_choice(m, value, field, name, err);
    case MEMBER_NUMBERS: return read_numbers(m, value, field, name, err);
    case MEMBER_ANY: *(json_t **)field = value; return true;
    }
    return false;
}

bool members_read(const json_t *object, const char *where, const struct member *table, void *out, struct given *given,
                  struct error *err)
{
    given->bits = 0;
    if (object && !json_is_object(object))
        return error_set(err, ERROR_USAGE, where, "%s: an object with named members is wanted; only { ... } is accepted",
                         *where ? where : "params");
    if (!refuse_unknown(object, where, table, err))
        return false;
    for (const struct member *m = table; m->name; m++) {
        json_t *value = json_object_get(object, m->name);
        struct member_path name = path_of(where, m->name);
        if (!value && m->required)
            return error_set(err, ERROR_USAGE, name.text, "%s is missing; it is required", name.text);
        if (!value)
            continue;
        if (!read_member(m, value, (char *)out + m->offset, name.text, err))
            return false;
        given->bits |= 1ull << m->bit;
    }
    return true;
}
