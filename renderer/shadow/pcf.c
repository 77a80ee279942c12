/* Percentage-closer filtering: Reeves, Salesin, Cook 1987, "Rendering antialiased shadows with depth maps". */
#include "shadow/depth/depth_pass.h"
#include "shadow/depth/light_maps.h"
#include "shadow/shared_params.h"

static const struct param_desc params[] = {
    SHADOW_MAP_PARAMS,
    SHADOW_BIAS_PARAMS(0.006, 0.25),
    {.name = "kernel",
     .unit = "texels",
     .help = "Side of the square of texels that are compared.",
     .kind = PARAM_INT,
     .min = 1,
     .max = 31,
     .initial = 5,
     .odd = true},
};

enum { PARAM_KERNEL = SHADOW_PARAM_SLOPE + 1 };

static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    if (in->resolve_on_cpu) {
        struct depth_square square;
        depth_square_flat(&square, (int)in->params[PARAM_KERNEL]);
        return depth_pass_filter(state, in, DEPTH_SQUARE, &square, 0, err);
    }
    return shadow_run_with_maps(state, in, "pcf.frag", err);
}

const struct shadow_system shadow_pcf = {
    .name = "pcf",
    .title = "Percentage-closer filtering",
    .help = "Depth map; the share of neighbouring texels that see the point.",
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
