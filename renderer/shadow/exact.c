/* Shadows that equal the reference's, sample for sample (exact/exact_shadows.h). Computed on the CPU: on a software GL device that is where
 * the shaders would run as well. */
#include "exact/exact_shadows.h"

#include <string.h>

#include "base/error.h"
#include "passes/gbuffer.h"
#include "shadow/pixel_pass.h"
#include "shadow/shared_params.h"

enum { PARAM_SAMPLES };

static const char *const samples_choices[] = {"1", "32", NULL};

static const struct param_desc params[] = {
    {.name = "samples",
     .unit = "a pixel",
     .help = "1: the pixel centre's receiver; 32: each sample has its own.",
     .kind = PARAM_CHOICE,
     .min = 0,
     .max = 1,
     .initial = 0,
     .choices = samples_choices},
};

struct state {
    struct exact_shadows *shadows;
    const uint32_t *receivers, *lit; /* of the last picture, 32 samples */
    size_t pixels;
};

static bool prepare(void *state, const struct shadow_input *in, struct error *err)
{
    struct state *s = state;
    if (!s->shadows && !(s->shadows = exact_shadows_create(in->scene, in->memory, err)))
        return false;
    return exact_shadows_set_light(s->shadows, in->light, in->pool, err);
}

static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    struct state *s = state;
    const float *visibility = NULL;
    s->pixels = 0;
    if (in->params[PARAM_SAMPLES] == 1) {
        visibility = exact_shadows_samples32(s->shadows, in->view, in->pool, &s->receivers, &s->lit, err);
        s->pixels = (size_t)in->view->width * in->view->height;
    } else {
        const uint32_t *ids = gbuffer_read_ids(in->gbuffer, in->gl, err);
        if (ids)
            visibility = exact_shadows_point(s->shadows, in->view, ids, in->pool, err);
    }
    if (!visibility)
        return false;
    return pixel_upload(in, visibility, err);
}

static bool read_masks(void *state, const struct shadow_input *in, uint32_t *receivers, uint32_t *lit, struct error *err)
{
    (void)err;
    const struct state *s = state;
    size_t pixels = (size_t)in->view->width * in->view->height;
    if (in->params[PARAM_SAMPLES] != 1 || s->pixels != pixels)
        return false;
    memcpy(receivers, s->receivers, pixels * sizeof *receivers);
    memcpy(lit, s->lit, pixels * sizeof *lit);
    return true;
}

static size_t figures(const void *state, struct shadow_figure *out)
{
    const struct state *s = state;
    struct exact_figures f = exact_shadows_figures(s->shadows);
    out[0] = (struct shadow_figure){"tests_per_receiver", f.tests_per_receiver};
    out[1] = (struct shadow_figure){"undecided_fraction", f.undecided_fraction};
    out[2] = (struct shadow_figure){"decided_exactly", f.exact};
    out[3] = (struct shadow_figure){"grid_side", f.grid_side};
    out[4] = (struct shadow_figure){"grid_entries", f.grid_entries};
    return 5;
}

static void finish(void *state) { exact_shadows_destroy(((struct state *)state)->shadows); }

static size_t bytes(const void *state)
{
    const struct state *s = state;
    return s->shadows ? exact_shadows_bytes(s->shadows) : 0;
}

const struct shadow_system shadow_exact = {
    .name = "exact",
    .title = "Exact",
    .help = "Equal to ray tracing, sample for sample; no bias.",
    .lights = 1 << LIGHT_DIRECTIONAL | 1 << LIGHT_POINT | 1 << LIGHT_SPOT,
    .flags = SHADOW_EXACT | SHADOW_FILLS,
    .params = params,
    .param_count = sizeof params / sizeof *params,
    .state_size = sizeof(struct state),
    .prepare = prepare,
    .resolve = resolve,
    .finish = finish,
    .bytes = bytes,
    .read_masks = read_masks,
    .figures = figures,
};
