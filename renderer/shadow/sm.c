/* Shadow map: Williams 1978, "Casting curved shadows on curved surfaces". */
#include "shadow/depth/depth_pass.h"
#include "shadow/depth/light_maps.h"
#include "shadow/shared_params.h"

static const struct param_desc params[] = {SHADOW_MAP_PARAMS, SHADOW_BIAS_PARAMS(0.00075, 0.5)};

static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    if (in->resolve_on_cpu)
        return depth_pass_filter(state, in, DEPTH_ONE, NULL, 0, err);
    return shadow_run_with_maps(state, in, "sm.frag", err);
}

const struct shadow_system shadow_sm = {
    .name = "sm",
    .title = "Shadow map",
    .help = "Depth map from the light; one comparison a pixel.",
    .lights = 1 << LIGHT_DIRECTIONAL | 1 << LIGHT_POINT | 1 << LIGHT_SPOT,
    .flags = SHADOW_USES_MAPS | SHADOW_BINARY | SHADOW_FILLS,
    .params = params,
    .param_count = sizeof params / sizeof *params,
    .state_size = sizeof(struct light_maps),
    .prepare = light_maps_prepare,
    .resolve = resolve,
    .finish = light_maps_finish,
    .bytes = light_maps_bytes,
};
