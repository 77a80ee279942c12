#include "against.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "numbers.h"
#include "trace/tracer.h"

static const double RADIUS_MAX = 1e9;
static const double RADIUS_MIN = 1e-9;
enum { RAYS_DEFAULT = 256 };

static bool area_setting(struct against *out, const char *key, const char *value, struct error *err)
{
    unsigned long rays;
    if (!strcmp(key, "radius")) {
        if (number_parse(value, RADIUS_MIN, RADIUS_MAX, &out->radius))
            return true;
        return error_set(err, ERROR_USAGE, "against",
                         "radius of arealight is '%s'; %g to %g scene units are accepted (directional lights: degrees)", value,
                         RADIUS_MIN, RADIUS_MAX);
    }
    if (!strcmp(key, "rays")) {
        bool good = number_parse_unsigned(value, 1, TRACER_AREA_RAYS_MAX, &rays);
        out->rays = good ? (unsigned)rays : 0;
        return good || error_set(err, ERROR_USAGE, "against", "rays of arealight is '%s'; 1 to %d are accepted", value,
                                 TRACER_AREA_RAYS_MAX);
    }
    return error_set(err, ERROR_USAGE, "against", "arealight has no '%s'; radius=R and rays=N are accepted", key);
}

static bool parse_area(const char *settings, struct against *out, struct error *err)
{
    char copy[256], *rest = NULL;
    out->kind = AGAINST_AREALIGHT;
    out->rays = RAYS_DEFAULT;
    if (snprintf(copy, sizeof copy, "%s", settings) >= (int)sizeof copy)
        return error_set(err, ERROR_USAGE, "against", "is too long; arealight:radius=R,rays=N is accepted");
    for (char *key = strtok_r(copy, ",", &rest); key; key = strtok_r(NULL, ",", &rest)) {
        char *equals = strchr(key, '=');
        if (!equals)
            return error_set(err, ERROR_USAGE, "against", "'%s' has no value; arealight:radius=R,rays=N is accepted", key);
        *equals = 0;
        if (!area_setting(out, key, equals + 1, err))
            return false;
    }
    return true;
}

bool against_parse(const char *text, struct against *out, struct error *err)
{
    *out = (struct against){.kind = AGAINST_POINT};
    if (!strcmp(text, "point"))
        return true;
    out->kind = AGAINST_SAMPLES32;
    if (!strcmp(text, "samples32"))
        return true;
    if (!strcmp(text, "arealight"))
        return parse_area("", out, err);
    if (!strncmp(text, "arealight:", 10))
        return parse_area(text + 10, out, err);
    out->kind = AGAINST_SYSTEM;
    if (shadow_parse(text, &out->system, &out->params, err))
        return true;
    snprintf(err->field, sizeof err->field, "against");
    return error_prefix(err, "none of point, samples32, arealight and an algorithm");
}

void against_format(const struct against *against, char *out, size_t size)
{
    switch (against->kind) {
    case AGAINST_POINT: snprintf(out, size, "point"); break;
    case AGAINST_SAMPLES32: snprintf(out, size, "samples32"); break;
    case AGAINST_SYSTEM: shadow_format(against->system, &against->params, out, size); break;
    case AGAINST_AREALIGHT:
        if (against->radius > 0)
            snprintf(out, size, "arealight:radius=%.9g,rays=%u", against->radius, against->rays);
        else
            snprintf(out, size, "arealight:rays=%u", against->rays);
        break;
    }
}
