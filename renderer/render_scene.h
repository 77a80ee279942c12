/* A scene as the renderer holds it: private to renderer.c and frame.c. */
#pragma once

#include "draw/draw_scene.h"
#include "renderer.h"
#include "shadow/fit.h"
#include "shadow/light_states.h"

struct render_scene {
    struct renderer *renderer;
    const struct scene *scene;
    struct draw_scene draw;
    struct fit_geometry fit;
    struct light_states states;
    struct tracer *tracer;                            /* made when first asked for */
    struct reference *reference;                      /* likewise */
    struct light_state *current[RENDERER_LIGHTS_MAX]; /* the last frame's, one a light */
};

/* What the inputs of all lights share. */
struct shadow_input render_scene_input(struct render_scene *s);

/* For struct shadow_input; `owner` is the render_scene. */
const struct tracer *render_scene_tracer(void *owner, struct error *err);
const struct reference *render_scene_reference(void *owner, struct error *err);
