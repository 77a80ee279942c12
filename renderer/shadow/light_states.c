#include "shadow/light_states.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "shadow/fit.h"

/* Frames after which an unused state is freed: longer than the pause between two views that take turns. */
#define KEEP_FRAMES 64

static bool same_vector(struct dvec3 a, struct dvec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

/* All that shadows depend on; colour and intensity are not. */
static bool same_light(const struct light *a, const struct light *b)
{
    return a->kind == b->kind && same_vector(a->position, b->position) && same_vector(a->direction, b->direction) &&
           a->radius == b->radius && a->inner == b->inner && a->outer == b->outer && a->range == b->range;
}

static bool same_params(const struct shadow_system *system, const struct shadow_params *a, const struct shadow_params *b)
{
    return memcmp(a->value, b->value, system->param_count * sizeof a->value[0]) == 0;
}

static void destroy(struct light_state *s)
{
    if (s->system->finish && s->state)
        s->system->finish(s->state);
    free(s->casters);
    free(s->state);
    free(s);
}

void light_states_begin(struct light_states *s)
{
    s->frame++;
    for (struct light_state **at = &s->first; *at;) {
        struct light_state *state = *at;
        if (state->last_frame + KEEP_FRAMES < s->frame) {
            *at = state->next;
            destroy(state);
        } else {
            at = &state->next;
        }
    }
}

/* First choice: built for just this light. Second: the same viewer's for the same light, before it moved; another viewer's would have to
 * be built anew for each of the two in turn. */
static struct light_state *find(struct light_states *s, const struct shadow_system *system, const struct shadow_params *params,
                                const struct shadow_input *in)
{
    struct light_state *moved = NULL;
    for (struct light_state *state = s->first; state; state = state->next) {
        if (state->system != system || !same_params(system, &state->params, params) || state->traced != in->trace_maps ||
            state->on_cpu != in->resolve_on_cpu || state->memory != in->memory)
            continue;
        bool own = state->viewer == in->viewer;
        if (same_light(&state->light, in->light) && (own || !(system->flags & SHADOW_VIEW_DRIVEN)))
            return state;
        if (own && state->light_index == in->light_index && state->last_frame < s->frame)
            moved = state;
    }
    return moved;
}

static struct light_state *create(struct light_states *s, const struct shadow_system *system, const struct shadow_params *params,
                                  const struct shadow_input *in, struct error *err)
{
    struct light_state *state = calloc(1, sizeof *state);
    if (!state || !(state->state = calloc(1, system->state_size + 1))) {
        free(state);
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for shadows");
        return NULL;
    }
    state->system = system;
    state->params = *params;
    state->light_index = in->light_index;
    state->viewer = in->viewer;
    state->traced = in->trace_maps;
    state->on_cpu = in->resolve_on_cpu;
    state->memory = in->memory;
    if (system->init && !system->init(state->state, in, err)) {
        destroy(state);
        return NULL;
    }
    state->next = s->first;
    s->first = state;
    return state;
}

/* still: the light is where it was when this ran last, so the fit stands. */
static bool prepare(struct light_state *state, const struct fit_geometry *geometry, struct shadow_input *in, bool still,
                    struct error *err)
{
    const struct shadow_system *system = state->system;
    in->fit = &state->fit;
    if (!still && system->flags & (SHADOW_USES_MAPS | SHADOW_USES_FIT)) {
        int size = shadow_param_index(system, "size"), fit = shadow_param_index(system, "fit");
        uint32_t side = size >= 0 ? (uint32_t)in->params[size] : SHADOW_FIT_SIDE;
        if (!state->casters)
            state->casters = malloc((geometry->scene->instance_count + 1) * sizeof *state->casters);
        if (!state->casters)
            return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for shadows");
        shadow_fit_compute(geometry, in->light, side, fit >= 0 && in->params[fit] == 1, state->casters, &state->fit);
    }
    return !system->prepare || system->prepare(state->state, in, err);
}

struct light_state *light_states_get(struct light_states *s, const struct fit_geometry *geometry,
                                     const struct shadow_system *system, const struct shadow_params *params,
                                     struct shadow_input *in, bool *rebuilt, struct error *err)
{
    in->params = params->value;
    struct light_state *state = find(s, system, params, in);
    if (!state && !(state = create(s, system, params, in, err)))
        return NULL;
    bool still = state->prepared && same_light(&state->light, in->light), stands = still && !(system->flags & SHADOW_VIEW_DRIVEN);
    if (!stands) {
        bool rest = state->prepared && system->converged && system->converged(state->state);
        state->light = *in->light;
        state->prepared = prepare(state, geometry, in, still, err);
        if (!state->prepared)
            return NULL;
        *rebuilt |= !(rest && light_state_converged(state));
    }
    state->light_index = in->light_index;
    state->viewer = in->viewer;
    state->last_frame = s->frame;
    in->fit = system->flags & (SHADOW_USES_MAPS | SHADOW_USES_FIT) ? &state->fit : NULL;
    return state;
}

void light_states_invalidate(struct light_states *s)
{
    for (struct light_state *state = s->first; state; state = state->next)
        state->prepared = false;
}

void light_states_finish(struct light_states *s)
{
    for (struct light_state *state = s->first, *next; state; state = next) {
        next = state->next;
        destroy(state);
    }
    s->first = NULL;
}

size_t light_state_bytes(const struct light_state *s) { return s->system->bytes ? s->system->bytes(s->state) : 0; }

bool light_state_converged(const struct light_state *s) { return !s->system->converged || s->system->converged(s->state); }
