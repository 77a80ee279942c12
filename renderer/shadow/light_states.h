/* What shadow systems keep between frames, one state a (light, system, parameters), shared by all views of a scene. A light's structure is
 * rebuilt only when the light or the parameters change (geometry is frozen); states that no frame asks for any more are freed. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/shadow.h"

struct error;
struct fit_geometry;

struct light_state {
    const struct shadow_system *system;
    struct shadow_params params;
    struct light light;
    unsigned light_index;
    uint32_t viewer; /* the last to ask; with light_index: whose structure is built anew when its light moves */
    bool prepared;
    bool traced; /* its maps were traced */
    bool on_cpu; /* and are resolved there */
    uint64_t last_frame;
    size_t memory; /* as in struct shadow_input */
    struct shadow_fit fit;
    uint32_t *casters; /* behind fit; owned */
    void *state;       /* system->state_size bytes */
    struct light_state *next;
};

struct light_states {
    struct light_state *first;
    uint64_t frame;
};

/* A new frame: frees what has not been asked for lately. */
void light_states_begin(struct light_states *s);

/* The state for in->light, prepared. `in` is complete but for fit, which this fills. rebuilt: set to true if prepare ran, else untouched. */
struct light_state *light_states_get(struct light_states *s, const struct fit_geometry *geometry,
                                     const struct shadow_system *system, const struct shadow_params *params,
                                     struct shadow_input *in, bool *rebuilt, struct error *err);

/* Forgets everything built: the next frame prepares anew (programs were reloaded). */
void light_states_invalidate(struct light_states *s);
void light_states_finish(struct light_states *s);

size_t light_state_bytes(const struct light_state *s);
bool light_state_converged(const struct light_state *s);
