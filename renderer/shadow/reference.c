/* The ray-traced reference as one more producer of the visibility buffer (reference/reference.h), and plain Embree as the speed baseline. */
#include "reference/reference.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "passes/gbuffer.h"
#include "shadow/pixel_pass.h"
#include "shadow/shared_params.h"
#include "trace/tracer.h"

enum { PARAM_SAMPLES, PARAM_TRACER };
enum { TRACER_EXACT, TRACER_EMBREE };

static const char *const samples_choices[] = {"1", "32", NULL};
static const char *const tracer_choices[] = {"exact", "embree", NULL};

static const struct param_desc params[] = {
    {.name = "samples",
     .unit = "a pixel",
     .help = "1: the pixel centre's receiver; 32: each sample has its own.",
     .kind = PARAM_CHOICE,
     .min = 0,
     .max = 1,
     .initial = 0,
     .choices = samples_choices},
    {.name = "tracer",
     .unit = "",
     .help = "exact: exact arithmetic where it matters; embree: plain single-precision rays, for speed.",
     .kind = PARAM_CHOICE,
     .min = 0,
     .max = 1,
     .initial = TRACER_EXACT,
     .choices = tracer_choices},
};

struct state {
    float *visibility;
    uint32_t *receivers, *lit; /* 32 samples */
    size_t pixels;
    bool masks; /* receivers and lit have room too */
};

static bool reserve(struct state *s, size_t pixels, bool masks, struct error *err)
{
    if (s->pixels >= pixels && (s->masks || !masks))
        return true;
    free(s->visibility);
    free(s->receivers);
    free(s->lit);
    s->visibility = malloc(pixels * sizeof *s->visibility);
    s->receivers = masks ? malloc(pixels * sizeof *s->receivers) : NULL;
    s->lit = masks ? malloc(pixels * sizeof *s->lit) : NULL;
    bool ok = s->visibility && (!masks || (s->receivers && s->lit));
    s->pixels = ok ? pixels : 0;
    s->masks = ok && masks;
    return ok || error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a picture's visibility");
}

static bool trace_point(struct state *s, const struct shadow_input *in, bool exact, struct error *err)
{
    const uint32_t *ids = gbuffer_read_ids(in->gbuffer, in->gl, err);
    if (!ids)
        return false;
    if (!exact) {
        const struct tracer *tracer = in->tracer(in->owner, err);
        if (tracer)
            tracer_shadow_point(tracer, in->view, in->light, ids, in->pool, s->visibility);
        return tracer != NULL;
    }
    const struct reference *reference = in->reference(in->owner, err);
    return reference && reference_point(reference, in->view, in->light, ids, in->pool, NULL, s->visibility, NULL, NULL);
}

static bool trace_samples(struct state *s, const struct shadow_input *in, bool exact, size_t pixels, struct error *err)
{
    if (exact) {
        const struct reference *reference = in->reference(in->owner, err);
        if (!reference || !reference_samples32(reference, in->view, in->light, in->pool, NULL, s->receivers, s->lit, NULL, NULL))
            return false;
    } else {
        const struct tracer *tracer = in->tracer(in->owner, err);
        if (!tracer)
            return false;
        tracer_shadow_samples32(tracer, in->view, in->light, in->pool, s->receivers, s->lit);
    }
    for (size_t i = 0; i < pixels; i++) {
        int receiving = __builtin_popcount(s->receivers[i]);
        s->visibility[i] = receiving ? (float)__builtin_popcount(s->lit[i]) / (float)receiving : 0;
    }
    return true;
}

static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    struct state *s = state;
    size_t pixels = (size_t)in->view->width * in->view->height;
    bool many = in->params[PARAM_SAMPLES] == 1, exact = in->params[PARAM_TRACER] == TRACER_EXACT;
    if (!reserve(s, pixels, many, err) || !(many ? trace_samples(s, in, exact, pixels, err) : trace_point(s, in, exact, err)))
        return false;
    return pixel_upload(in, s->visibility, err);
}

static bool read_masks(void *state, const struct shadow_input *in, uint32_t *receivers, uint32_t *lit, struct error *err)
{
    const struct state *s = state;
    (void)err;
    size_t pixels = (size_t)in->view->width * in->view->height;
    if (in->params[PARAM_SAMPLES] != 1 || !s->masks || s->pixels < pixels)
        return false;
    memcpy(receivers, s->receivers, pixels * sizeof *receivers);
    memcpy(lit, s->lit, pixels * sizeof *lit);
    return true;
}

static void finish(void *state)
{
    struct state *s = state;
    free(s->visibility);
    free(s->receivers);
    free(s->lit);
}

static size_t bytes(const void *state)
{
    const struct state *s = state;
    return s->pixels * (s->masks ? 12 : 4);
}

const struct shadow_system shadow_reference = {
    .name = "reference",
    .title = "Ray-traced reference",
    .help = "The truth that the others are measured against.",
    .lights = 1 << LIGHT_DIRECTIONAL | 1 << LIGHT_POINT | 1 << LIGHT_SPOT,
    .flags = SHADOW_EXACT | SHADOW_FILLS,
    .params = params,
    .param_count = sizeof params / sizeof *params,
    .state_size = sizeof(struct state),
    .resolve = resolve,
    .finish = finish,
    .bytes = bytes,
    .read_masks = read_masks,
};
