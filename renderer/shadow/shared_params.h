/* Parameters that several systems share, and the full-screen pass most of them end in. */
#pragma once

#include <stdbool.h>

#include "shadow/shadow.h"

extern const char *const shadow_fit_choices[];

enum { SHADOW_PARAM_SIZE, SHADOW_PARAM_FIT, SHADOW_PARAM_BIAS, SHADOW_PARAM_SLOPE };

/* The first two descriptors of every map system. */
#define SHADOW_MAP_PARAMS                                                                                                 \
    {.name = "size",                                                                                                      \
     .unit = "texels",                                                                                                    \
     .help = "Side of each map.",                                                                                         \
     .kind = PARAM_INT,                                                                                                   \
     .min = 16,                                                                                                           \
     .max = 16384,                                                                                                        \
     .initial = 1024},                                                                                                    \
    {                                                                                                                     \
        .name = "fit", .unit = "", .help = "tight: one map around the casters where it can be; cube: always cube faces.", \
        .kind = PARAM_CHOICE, .min = 0, .max = 1, .initial = 0, .choices = shadow_fit_choices                             \
    }

/* The next two of those that compare depths with a bias, SHADOW_PARAM_BIAS and _SLOPE. Defaults: the pair with the fewest misclassified pixels over the four
 * paper models at size 1024 (docs/bias.md). */
#define SHADOW_BIAS_PARAMS(bias_default, slope_default)                                                                       \
    {.name = "bias",                                                                                                          \
     .unit = "scene units",                                                                                                   \
     .help = "Depth by which a point may lie behind the stored surface and still be lit.",                                    \
     .kind = PARAM_FLOAT,                                                                                                     \
     .min = 0,                                                                                                                \
     .max = 1e6,                                                                                                              \
     .initial = (bias_default)},                                                                                              \
    {                                                                                                                         \
        .name = "slope", .unit = "", .help = "More of it: times a texel's size times the tangent of the angle of incidence.", \
        .kind = PARAM_FLOAT, .min = 0, .max = 1e3, .initial = (slope_default)                                                 \
    }

struct light_maps;

/* Runs `fragment` over the picture, into the bound framebuffer, with receivers, light and parameters bound. */
bool shadow_run_full_screen(const struct shadow_input *in, const char *fragment, const char *defines, struct error *err);

/* The same for a shader that includes maps.glsl. Without maps, every receiver is lit. */
bool shadow_run_with_maps(struct light_maps *maps, const struct shadow_input *in, const char *fragment, struct error *err);
