/* No shadows: every receiver is lit. What the others are measured against from below. */
#include "shadow/depth/depth_pass.h"
#include "shadow/shared_params.h"

static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    (void)state;
    if (in->resolve_on_cpu)
        return depth_pass_lit(in, err);
    return shadow_run_full_screen(in, "none.frag", NULL, err);
}

const struct shadow_system shadow_none = {
    .name = "none",
    .title = "No shadows",
    .help = "Every surface that faces a light is lit by it.",
    .lights = 1 << LIGHT_DIRECTIONAL | 1 << LIGHT_POINT | 1 << LIGHT_SPOT,
    .flags = SHADOW_NO_SHADOWS | SHADOW_BINARY | SHADOW_FILLS,
    .resolve = resolve,
};
