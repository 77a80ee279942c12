#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "shadow/shadow.h"

struct shadow_params shadow_defaults(const struct shadow_system *system)
{
    struct shadow_params params = {0};
    for (size_t i = 0; i < system->param_count; i++)
        params.value[i] = system->params[i].initial;
    return params;
}

int shadow_param_index(const struct shadow_system *system, const char *key)
{
    for (size_t i = 0; i < system->param_count; i++)
        if (strcmp(system->params[i].name, key) == 0)
            return (int)i;
    return -1;
}

static void append(char *out, size_t size, const char *text)
{
    size_t used = strlen(out);
    if (used < size)
        snprintf(out + used, size - used, "%s", text);
}

static bool unknown_param(const struct shadow_system *system, const char *key, struct error *err)
{
    char list[200] = "";
    for (size_t i = 0; i < system->param_count; i++) {
        append(list, sizeof list, i ? ", " : "");
        append(list, sizeof list, system->params[i].name);
    }
    return error_set(err, ERROR_USAGE, key[0] ? key : "algorithm", "%s has no parameter '%.60s'; it takes %s", system->name, key,
                     list[0] ? list : "none");
}

static bool parse_choice(const struct shadow_system *system, const struct param_desc *p, const char *value, double *out,
                         struct error *err)
{
    char list[160] = "";
    for (int i = 0; p->choices[i]; i++) {
        if (strcmp(p->choices[i], value) == 0) {
            *out = i;
            return true;
        }
        append(list, sizeof list, i ? ", " : "");
        append(list, sizeof list, p->choices[i]);
    }
    return error_set(err, ERROR_USAGE, p->name, "%s: %s=%.60s is not known; choose one of %s", system->name, p->name, value,
                     list);
}

static bool parse_number(const struct shadow_system *system, const struct param_desc *p, const char *value, double *out,
                         struct error *err)
{
    char *end;
    double number = strtod(value, &end);
    bool decimal = strspn(value, "0123456789+-.eE") == strlen(value);
    bool whole = p->kind != PARAM_INT || number == floor(number);
    bool odd = !p->odd || fmod(number, 2) == 1;
    if (end == value || *end || !decimal || !isfinite(number) || number < p->min || number > p->max || !whole || !odd)
        return error_set(err, ERROR_USAGE, p->name, "%s: %s=%.60s is not possible; %s %.9g to %.9g%s%s is accepted", system->name,
                         p->name, value,
                         p->odd                 ? "an odd number from"
                         : p->kind == PARAM_INT ? "a whole number from"
                                                : "a number from",
                         p->min, p->max, p->unit[0] ? " " : "", p->unit);
    *out = number;
    return true;
}

bool shadow_param_parse(const struct shadow_system *system, struct shadow_params *params, const char *key, const char *value,
                        struct error *err)
{
    int i = shadow_param_index(system, key);
    if (i < 0)
        return unknown_param(system, key, err);
    const struct param_desc *p = &system->params[i];
    return p->kind == PARAM_CHOICE ? parse_choice(system, p, value, &params->value[i], err)
                                   : parse_number(system, p, value, &params->value[i], err);
}

static bool unknown_system(const char *name, int length, struct error *err)
{
    char list[200] = "";
    for (size_t i = 0; i < shadow_system_count; i++) {
        append(list, sizeof list, i ? ", " : "");
        append(list, sizeof list, shadow_systems[i]->name);
    }
    return error_set(err, ERROR_USAGE, "algorithm", "no algorithm '%.*s'; choose one of %s", length, name, list);
}

/* One "key=value" of `length` characters. */
static bool parse_pair(const struct shadow_system *system, struct shadow_params *params, const char *text, size_t length,
                       struct error *err)
{
    char pair[128];
    if (length >= sizeof pair)
        return error_set(err, ERROR_USAGE, "algorithm", "%s: parameter '%.40s...' is too long; NAME[:key=value,...] is accepted",
                         system->name, text);
    memcpy(pair, text, length);
    pair[length] = 0;
    char *equals = strchr(pair, '=');
    if (!equals)
        return error_set(err, ERROR_USAGE, "algorithm", "%s: '%s' is not key=value; NAME[:key=value,...] is accepted",
                         system->name, pair);
    *equals = 0;
    return shadow_param_parse(system, params, pair, equals + 1, err);
}

bool shadow_parse(const char *text, const struct shadow_system **system, struct shadow_params *params, struct error *err)
{
    size_t length = strcspn(text, ":");
    *system = shadow_find(text, length);
    if (!*system)
        return unknown_system(text, length < 60 ? (int)length : 60, err);
    *params = shadow_defaults(*system);
    const char *at = text + length;
    while (*at) {
        at++; /* the ':' or ',' before a pair */
        size_t pair = strcspn(at, ",");
        if (!parse_pair(*system, params, at, pair, err))
            return false;
        at += pair;
    }
    return true;
}

void shadow_format(const struct shadow_system *system, const struct shadow_params *params, char *out, size_t size)
{
    snprintf(out, size, "%s", system->name);
    for (size_t i = 0; i < system->param_count; i++) {
        const struct param_desc *p = &system->params[i];
        char pair[80];
        if (p->kind == PARAM_CHOICE)
            snprintf(pair, sizeof pair, "%c%s=%s", i ? ',' : ':', p->name, p->choices[(int)params->value[i]]);
        else
            snprintf(pair, sizeof pair, "%c%s=%.9g", i ? ',' : ':', p->name, params->value[i]);
        append(out, size, pair);
    }
}
