/* Adaptive percentage-closer filtering: Zhang, Yang, Liu 2012, "Design and implementation of an algorithm of real-time shadow rendering".
 * Where the text is silent: docs/filtered.md. */
#include <stdio.h>
#include <stdlib.h>

#include "shadow/depth/depth_pass.h"
#include "shadow/depth/light_maps.h"
#include "shadow/shared_params.h"

enum { PARAM_TEMPLATE = SHADOW_PARAM_SLOPE + 1, PARAM_WEIGHTS, PARAM_UMBRA };

static const char *const weights_choices[] = {"product", "sum", "flat", NULL};

static const struct param_desc params[] = {
    SHADOW_MAP_PARAMS,
    SHADOW_BIAS_PARAMS(0.004, 0.25),
    {.name = "template",
     .unit = "texels",
     .help = "Side of the square whose corners decide, or all of it.",
     .kind = PARAM_INT,
     .min = 3,
     .max = 31,
     .initial = 5,
     .odd = true},
    {.name = "weights",
     .unit = "",
     .help = "1 in the corners, rising to the middle: by the product or the sum of the distances from the edges; or equal.",
     .kind = PARAM_CHOICE,
     .min = 0,
     .max = 2,
     .initial = 0,
     .choices = weights_choices},
    {.name = "umbra",
     .unit = "",
     .help = "What is left of the light in full shadow; the paper's figures have 0.5.",
     .kind = PARAM_FLOAT,
     .min = 0,
     .max = 1,
     .initial = 0},
};

static void weigh(struct depth_square *s, int weights)
{
    int reach = s->side / 2;
    s->total = 0;
    for (int y = 0; y < s->side; y++)
        for (int x = 0; x < s->side; x++) {
            int a = reach + 1 - abs(x - reach), b = reach + 1 - abs(y - reach);
            s->weight[y][x] = weights == 0 ? a * b : weights == 1 ? a + b - 1 : 1;
            s->total += s->weight[y][x];
        }
}

static bool resolve_on_cpu(const struct light_maps *maps, const struct shadow_input *in, struct error *err)
{
    struct depth_square square;
    depth_square_flat(&square, (int)in->params[PARAM_TEMPLATE]);
    weigh(&square, (int)in->params[PARAM_WEIGHTS]);
    return depth_pass_filter(maps, in, DEPTH_ADAPTIVE, &square, (float)in->params[PARAM_UMBRA], err);
}

static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    struct light_maps *maps = state;
    char defines[96];
    if (in->resolve_on_cpu)
        return resolve_on_cpu(maps, in, err);
    if (maps->fit.map_count == 0)
        return shadow_run_full_screen(in, "none.frag", NULL, err);
    snprintf(defines, sizeof defines, "MAPS %u\nMAP_PERSPECTIVE %d\nTEMPLATE %d\nWEIGHTS %d\n", maps->fit.map_count,
             !maps->fit.maps[0].orthographic, (int)in->params[PARAM_TEMPLATE], (int)in->params[PARAM_WEIGHTS]);
    return light_maps_bind(maps, in, err) && shadow_run_full_screen(in, "apcf.frag", defines, err);
}

const struct shadow_system shadow_apcf = {
    .name = "apcf",
    .title = "Adaptive percentage-closer filtering",
    .help = "Depth map; four corners decide, and only near a shadow's edge the weighted share of the texels between them.",
    .lights = 1 << LIGHT_DIRECTIONAL | 1 << LIGHT_POINT | 1 << LIGHT_SPOT,
    .flags = SHADOW_USES_MAPS | SHADOW_FILLS,
    .params = params,
    .param_count = sizeof params / sizeof *params,
    .state_size = sizeof(struct light_maps),
    .prepare = light_maps_prepare,
    .resolve = resolve,
    .finish = light_maps_finish,
    .bytes = light_maps_bytes,
};
