#include "frame.h"

#include <epoxy/gl.h>
#include <math.h>
#include <string.h>

#include "blocks.h"
#include "draw/producer.h"
#include "draw/put_vec4.h"
#include "gl/program.h"
#include "passes/camera.h"
#include "render_scene.h"

_Static_assert((int)SHOW_SHADED == LIGHTING_SHADED && (int)SHOW_VISIBILITY == LIGHTING_VISIBILITY &&
                   (int)SHOW_DEPTH == LIGHTING_DEPTH && (int)SHOW_NORMAL == LIGHTING_NORMAL && (int)SHOW_ID == LIGHTING_ID,
               "enum show and enum lighting_show");
_Static_assert(RENDERER_LIGHTS_MAX == LIGHTS_MAX && SHADOW_MAPS_MAX == MAPS_MAX && SHADOW_PARAM_MAX <= 16, "blocks.h");

static void mark(struct renderer *r, enum render_pass pass, struct frame_info *info)
{
    info->pass_ms[pass] = gl_timer_mark(&r->timer, pass);
}

static bool run_camera(struct renderer *r, struct render_scene *s, const struct render_settings *settings,
                       struct frame_info *info, struct error *err)
{
    size_t pixels = (size_t)r->gbuffer.view.view.width * r->gbuffer.view.view.height;
    info->traced_camera = settings->camera_pass == CAMERA_PASS_AUTO ? producer_traces_camera(&s->draw, pixels)
                                                                    : settings->camera_pass == CAMERA_PASS_TRACED;
    if (info->traced_camera) {
        const struct tracer *tracer = render_scene_tracer(s, err);
        if (!tracer || !camera_trace(&r->gbuffer, &s->draw, tracer, r->pool, err))
            return false;
    } else if (!camera_rasterize(&r->gbuffer, &s->draw, err)) {
        return false;
    }
    mark(r, PASS_CAMERA, info);
    bool ok = camera_surfaces(&r->gbuffer, &s->draw, err);
    mark(r, PASS_RECEIVERS, info);
    return ok;
}

/* What shaders/receiver.glsl and PARAM() read. */
static bool bind_light(struct renderer *r, const struct shadow_input *in, size_t param_count, struct error *err)
{
    struct light_block block = {0};
    put_vec4(block.light_position, dvec3_sub(in->light->position, in->view->eye), in->light->kind);
    put_vec4(block.light_direction, in->light->direction, in->light->kind == LIGHT_DIRECTIONAL ? 0 : in->light->range);
    put_vec4(block.light_cone, dvec3(cos(in->light->outer), 0, 0), 0);
    struct params_block params = {0};
    for (size_t i = 0; i < param_count; i++)
        params.params[i / 4][i % 4] = (float)in->params[i];
    if (!gl_buffer_set(&r->light_block, &r->gl, &block, sizeof block, 0, err) ||
        !gl_buffer_set(&r->params_block, &r->gl, &params, sizeof params, 0, err))
        return false;
    glBindBufferBase(GL_UNIFORM_BUFFER, 2, r->light_block.id);
    glBindBufferBase(GL_UNIFORM_BUFFER, 4, r->params_block.id);
    return true;
}

/* Whoever gives a folder of shaders wants to see them at work. */
static bool works_on_cpu(const struct render_scene *s, const struct render_settings *settings)
{
    return settings->resolve_pass == RESOLVE_PASS_AUTO
               ? producer_resolves_on_cpu(&s->draw) && !gl_programs_are_files(s->renderer->programs)
               : settings->resolve_pass == RESOLVE_PASS_CPU;
}

static bool traces_maps(const struct render_scene *s, const struct render_settings *settings)
{
    unsigned flags = settings->system->flags;
    if (!(flags & (SHADOW_USES_MAPS | SHADOW_USES_FIT)))
        return false;
    if (settings->map_pass != CAMERA_PASS_AUTO)
        return settings->map_pass == CAMERA_PASS_TRACED;
    bool on_cpu = works_on_cpu(s, settings);
    /* Maps in small pieces: llvmpipe draws a page in 50 us (builtin:box, builtin:contact), in which the CPU traces fifteen. */
    if (on_cpu && flags & SHADOW_USES_FIT)
        return true;
    int size = shadow_param_index(settings->system, "size");
    double side = size >= 0 ? settings->params.value[size] : SHADOW_FIT_SIDE;
    size_t texels = (size_t)(side * side);
    return on_cpu ? producer_traces_map_on_cpu(&s->draw, texels) : producer_traces_map(&s->draw, texels);
}

static struct shadow_input input_for(struct renderer *r, struct render_scene *s, const struct render_settings *settings,
                                     unsigned light)
{
    struct shadow_input in = render_scene_input(s);
    in.light = &settings->lights[light];
    in.light_index = light;
    in.viewer = settings->viewer;
    in.view = &r->gbuffer.view.view;
    in.trace_maps = traces_maps(s, settings);
    /* Pieces that GL drew stay there. */
    in.resolve_on_cpu = works_on_cpu(s, settings) && (in.trace_maps || !(settings->system->flags & SHADOW_USES_FIT));
    in.memory = settings->light_count ? settings->memory / settings->light_count : 0;
    return in;
}

static bool prepare_lights(struct renderer *r, struct render_scene *s, const struct render_settings *settings,
                           struct shadow_input *inputs, struct frame_info *info, struct error *err)
{
    light_states_begin(&s->states);
    memset(s->current, 0, sizeof s->current);
    for (unsigned i = 0; i < settings->light_count; i++) {
        inputs[i] = input_for(r, s, settings, i);
        s->current[i] =
            light_states_get(&s->states, &s->fit, settings->system, &settings->params, &inputs[i], &info->prepared, err);
        if (!s->current[i])
            return false;
    }
    mark(r, PASS_PREPARE, info);
    return true;
}

static struct lighting_input lighting_of(struct renderer *r, struct render_scene *s, const struct render_settings *settings,
                                         unsigned aa_side)
{
    double lux = lighting_illuminance(s->scene, settings->lights, settings->light_count);
    /* auto: white facing all lights at the scene's centre becomes 1. */
    double automatic = lux > 0 ? M_PI / lux : 1;
    bool plain = settings->tonemap == TONEMAP_NONE || settings->show != SHOW_SHADED;
    return (struct lighting_input){
        .scene = &s->draw,
        .gbuffer = &r->gbuffer,
        .visibility = &r->visibility,
        .pool = r->pool,
        .lights = settings->lights,
        .light_count = settings->light_count,
        .show = (enum lighting_show)settings->show,
        .display = settings->format == PIXELS_RGBA32F ? LIGHTING_LINEAR
                   : plain                            ? LIGHTING_SRGB
                                                      : LIGHTING_ACES,
        .exposure = settings->exposure_auto ? automatic : exp2(settings->exposure_ev),
        .ambient = settings->ambient * (lux > 0 ? lux / M_PI : 1),
        .aa_side = aa_side,
    };
}

static bool resolve_lights(struct renderer *r, const struct render_settings *settings, struct shadow_input *inputs,
                           const struct light_state *const *states, bool keep, struct frame_info *info, struct error *err)
{
    const struct view *view = &r->gbuffer.view.view;
    uint32_t layers = settings->light_count ? (uint32_t)settings->light_count : 1;
    if (!visibility_begin(&r->visibility, &r->gl, view->width, view->height, layers, &r->gbuffer.tiles, keep, err))
        return false;
    for (unsigned i = 0; i < settings->light_count; i++) {
        if (!keep || !inputs[i].resolve_on_cpu || !(settings->system->flags & SHADOW_FILLS))
            visibility_bind(&r->visibility, i);
        inputs[i].layer = &r->visibility.layers[i];
        if (!bind_light(r, &inputs[i], settings->system->param_count, err) ||
            !settings->system->resolve(states[i]->state, &inputs[i], err))
            return false;
    }
    mark(r, PASS_RESOLVE, info);
    return true;
}

static void describe_lights(const struct render_scene *s, const struct render_settings *settings, struct frame_info *info)
{
    info->converged = true;
    for (size_t i = 0; i < settings->light_count; i++) {
        bool shared = false; /* equal lights share a state */
        for (size_t k = 0; k < i; k++)
            shared |= s->current[k] == s->current[i];
        info->shadow_bytes += shared ? 0 : light_state_bytes(s->current[i]);
        info->map_count_total += s->current[i]->fit.map_count;
        info->converged &= light_state_converged(s->current[i]);
    }
    if (settings->light_count == 0)
        return;
    const struct shadow_fit *fit = &s->current[0]->fit;
    info->map_count = fit->map_count;
    info->map_size = fit->map_count ? fit->maps[0].width : 0;
    memcpy(info->map_fov_deg, fit->fov_deg, sizeof info->map_fov_deg);
    info->figure_count = renderer_read_figures(s, 0, info->figures);
}

bool frame_render(struct renderer *r, struct render_scene *s, const struct render_settings *settings, struct frame_info *info,
                  struct error *err)
{
    unsigned aa_side = settings->aa == 16 ? 4 : settings->aa == 4 ? 2 : 1;
    struct view view = view_from_camera(&settings->camera, settings->width * aa_side, settings->height * aa_side);
    view_limit_far(&view, &s->scene->bounds);
    struct shadow_input inputs[RENDERER_LIGHTS_MAX];
    const struct lighting_input lighting = lighting_of(r, s, settings, aa_side);
    bool keep = works_on_cpu(s, settings) && lighting_fits_cpu(&lighting);
    gl_timer_begin(&r->timer, settings->finish_each_pass);
    bool ok = gbuffer_begin(&r->gbuffer, &s->draw, &view, err) && run_camera(r, s, settings, info, err) &&
              prepare_lights(r, s, settings, inputs, info, err) &&
              resolve_lights(r, settings, inputs, (const struct light_state *const *)s->current, keep, info, err) &&
              lighting_run(&r->lighting, &lighting, err);
    if (ok) {
        mark(r, PASS_LIGHTING, info);
        describe_lights(s, settings, info);
    }
    return ok;
}
