/* What a comparison takes for true: REF of `gnomon compare --against` and of compare.run. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "shadow/shadow.h"

struct error;

enum against_kind { AGAINST_POINT, AGAINST_SAMPLES32, AGAINST_AREALIGHT, AGAINST_SYSTEM };

/* What is taken for true. */
struct against {
    enum against_kind kind;
    const struct shadow_system *system; /* AGAINST_SYSTEM */
    struct shadow_params params;
    double radius; /* AGAINST_AREALIGHT: of the light's disc, scene units (directional: degrees); 0: tracer_area_radius() */
    unsigned rays; /* AGAINST_AREALIGHT: a pixel */
};

/* "point", "samples32", "arealight[:radius=R,rays=N]" or an algorithm with parameters. ERROR_USAGE. */
bool against_parse(const char *text, struct against *out, struct error *err);
/* The same back, every parameter written out. `out` holds at least 256 bytes. */
void against_format(const struct against *against, char *out, size_t size);
