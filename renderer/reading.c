/* What a frame left behind, read back for measuring. */
#include <string.h>

#include "frame.h"
#include "render_scene.h"

bool renderer_read_visibility(struct renderer *r, unsigned light, float *out)
{
    return visibility_read(&r->visibility, &r->gl, light, out);
}

bool renderer_read_ids(struct renderer *r, uint32_t *out)
{
    struct error err = {0};
    const uint32_t *ids = gbuffer_read_ids(&r->gbuffer, &r->gl, &err);
    if (ids)
        memcpy(out, ids, (size_t)r->gbuffer.ids.width * r->gbuffer.ids.height * sizeof *out);
    return ids != NULL;
}

/* What the light's system was given for the last frame. */
static struct shadow_input input_of(struct render_scene *s, unsigned light)
{
    const struct light_state *state = s->current[light];
    struct shadow_input in = render_scene_input(s);
    in.light = &state->light;
    in.light_index = light;
    in.viewer = state->viewer;
    in.fit = state->system->flags & (SHADOW_USES_MAPS | SHADOW_USES_FIT) ? &state->fit : NULL;
    in.params = state->params.value;
    in.view = &s->renderer->gbuffer.view.view;
    in.trace_maps = state->traced;
    in.resolve_on_cpu = state->on_cpu;
    in.memory = state->memory;
    return in;
}

size_t renderer_read_figures(const struct render_scene *s, unsigned light, struct shadow_figure out[SHADOW_FIGURES_MAX])
{
    const struct light_state *state = s->current[light];
    return state && state->system->figures ? state->system->figures(state->state, out) : 0;
}

bool renderer_read_masks(struct render_scene *s, unsigned light, uint32_t *receivers, uint32_t *lit, struct error *err)
{
    const struct light_state *state = s->current[light];
    if (!state || !state->system->read_masks)
        return false;
    const struct shadow_input in = input_of(s, light);
    return state->system->read_masks(state->state, &in, receivers, lit, err);
}

bool renderer_read_lists(struct render_scene *s, unsigned light, struct shadow_lists *out, struct shadow_fit *fit,
                         struct error *err)
{
    const struct light_state *state = s->current[light];
    if (!state || !state->system->read_lists)
        return false;
    const struct shadow_input in = input_of(s, light);
    *fit = state->fit;
    return state->system->read_lists(state->state, &in, out, err);
}
