#include "render_scene.h"

#include <stdlib.h>

#include "frame.h"
#include "reference/reference.h"
#include "trace/tracer.h"

struct render_scene *render_scene_create(struct renderer *r, const struct scene *scene, struct error *err)
{
    struct render_scene *s = calloc(1, sizeof *s);
    if (!s) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the scene");
        return NULL;
    }
    s->renderer = r;
    s->scene = scene;
    if (!draw_scene_init(&s->draw, &r->gl, scene, err) || !fit_geometry_init(&s->fit, scene, err)) {
        render_scene_destroy(s);
        return NULL;
    }
    return s;
}

void render_scene_destroy(struct render_scene *s)
{
    if (!s)
        return;
    light_states_finish(&s->states);
    tracer_destroy(s->tracer);
    reference_destroy(s->reference);
    fit_geometry_finish(&s->fit);
    draw_scene_finish(&s->draw);
    free(s);
}

const struct tracer *render_scene_tracer(void *owner, struct error *err)
{
    struct render_scene *s = owner;
    if (!s->tracer)
        s->tracer = tracer_create(s->scene, s->renderer->threads, err);
    return s->tracer;
}

const struct reference *render_scene_reference(void *owner, struct error *err)
{
    struct render_scene *s = owner;
    if (!s->reference)
        s->reference = reference_create(s->scene, s->renderer->threads, err);
    return s->reference;
}

struct shadow_input render_scene_input(struct render_scene *s)
{
    struct renderer *r = s->renderer;
    return (struct shadow_input){
        .scene = s->scene,
        .gbuffer = &r->gbuffer,
        .draw = &s->draw,
        .tracer = render_scene_tracer,
        .reference = render_scene_reference,
        .owner = s,
        .pool = r->pool,
        .gl = &r->gl,
    };
}
