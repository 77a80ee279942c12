#include "against.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"

bool against_parse(const char *text, struct against *out, struct error *err)
{
    *out = (struct against){.kind = AGAINST_POINT};
    if (!strcmp(text, "point"))
        return true;
    out->kind = AGAINST_SAMPLES32;
    if (!strcmp(text, "samples32"))
        return true;
    if (!strncmp(text, "arealight", 9))
        return error_set(err, ERROR_USAGE, "against", "arealight is not built yet; point, samples32 or an algorithm is accepted");
    out->kind = AGAINST_SYSTEM;
    if (shadow_parse(text, &out->system, &out->params, err))
        return true;
    snprintf(err->field, sizeof err->field, "against");
    return error_prefix(err, "neither point nor samples32 nor an algorithm");
}

void against_format(const struct against *against, char *out, size_t size)
{
    if (against->kind == AGAINST_SYSTEM)
        shadow_format(against->system, &against->params, out, size);
    else
        snprintf(out, size, "%s", against->kind == AGAINST_POINT ? "point" : "samples32");
}
