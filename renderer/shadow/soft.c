/* Distance-dependent soft shadows in screen space: Liu, Wang, Chen, Zhang, "Design and implementation of an algorithm of real-time soft shadow
 * rendering". The formulas that its text lacks are ours: docs/filtered.md. */
#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "blocks.h"
#include "gl/context.h"
#include "shadow/depth/light_maps.h"
#include "shadow/depth/map_ranges.h"
#include "shadow/shared_params.h"
#include "shadow/depth/soft_pass.h"
#include "trace/tracer.h"

enum { PARAM_NEAR = SHADOW_PARAM_SLOPE + 1, PARAM_FAR, PARAM_LIFT };

static const struct param_desc params[] = {
    SHADOW_MAP_PARAMS,
    SHADOW_BIAS_PARAMS(0.006, 0.25),
    {.name = "near",
     .unit = "pixels",
     .help = "Standard deviation of the blur where an occluder touches the receiver: no edge is blurred less.",
     .kind = PARAM_FLOAT,
     .min = 0,
     .max = 16,
     .initial = 0.3},
    {.name = "far",
     .unit = "light radii",
     .help = "Largest radius of the blur, across the light; a radius is the light's, or 2 % of its distance, or 0.5 degrees.",
     .kind = PARAM_FLOAT,
     .min = 0,
     .max = 16,
     .initial = 2},
    {.name = "lift",
     .unit = "",
     .help = "Brightness that a shadow has gained where its blur is as wide as far.",
     .kind = PARAM_FLOAT,
     .min = 0,
     .max = 1,
     .initial = 0.1},
};

struct soft {
    struct light_maps maps;
    struct soft_pass on_cpu;
    struct map_ranges ranges; /* this and the rest: on the GPU */
    /* Of the largest width and height seen: views of several sizes take turns. */
    struct gl_texture term, radius, blurred;
    struct gl_target target;
    struct gl_buffer block;
};

/* The light's radius in scene units; a directional light's at the depth of its map. */
static double light_radius(const struct soft *s, const struct shadow_input *in)
{
    const struct view *map = &s->maps.fit.maps[0];
    double radius = tracer_area_radius(in->scene, in->light);
    return in->light->kind == LIGHT_DIRECTIONAL ? tan(fmin(radius, 85) * M_PI / 180) * (map->far - map->near) : radius;
}

/* Side of the blocks of ranges, texels: as far as an edge may be blurred on the farthest receivers. */
static uint32_t block_side(const struct soft *s, const struct shadow_input *in)
{
    const struct view *map = &s->maps.fit.maps[0];
    double texels = map->width / (map->right_edge - map->left), radius = light_radius(s, in);
    double across = map->orthographic ? radius : radius * fmin(in->params[PARAM_FAR], 1) / map->near;
    uint32_t side = 8;
    while (side < 64 && side < across * texels)
        side *= 2;
    return side;
}

static bool prepare(void *state, const struct shadow_input *in, struct error *err)
{
    struct soft *s = state;
    if (!light_maps_prepare(&s->maps, in, err))
        return false;
    if (s->maps.fit.map_count == 0)
        return true;
    return in->resolve_on_cpu ? soft_pass_prepare(&s->on_cpu, &s->maps, in, block_side(s, in), err)
                              : map_ranges_prepare(&s->ranges, &s->maps, in, block_side(s, in), err);
}

static bool reserve(struct soft *s, const struct shadow_input *in, struct error *err)
{
    uint32_t width = in->view->width > s->term.width ? in->view->width : s->term.width;
    uint32_t height = in->view->height > s->term.height ? in->view->height : s->term.height;
    return gl_texture_size(&s->term, in->gl, GL_R32UI, width, height, err) &&
           gl_texture_size(&s->radius, in->gl, GL_R32UI, width, height, err) &&
           gl_texture_size(&s->blurred, in->gl, GL_R32UI, width, height, err);
}

static bool bind(struct soft *s, const struct shadow_input *in, struct error *err)
{
    struct soft_block block = {.soft_light = {(float)light_radius(s, in), (float)s->ranges.block},
                               .soft_size = {in->view->width, in->view->height}};
    if (!gl_buffer_set(&s->block, in->gl, &block, sizeof block, 0, err))
        return false;
    glBindBufferBase(GL_UNIFORM_BUFFER, 6, s->block.id);
    map_ranges_bind(&s->ranges);
    gl_texture_bind(&s->radius, UNIT_SOFT_RADIUS);
    return light_maps_bind(&s->maps, in, err);
}

/* Everywhere, since taps reach into tiles without surfaces. */
static void start_pass(struct soft *s, const struct shadow_input *in, const struct gl_texture *to,
                       const struct gl_texture *second)
{
    static const GLuint nothing[4];
    gl_target_attach_two(&s->target, to, second);
    gl_target_bind(&s->target, in->view->width, in->view->height);
    glClearNamedFramebufferuiv(s->target.id, GL_COLOR, 0, nothing);
}

static bool run_term(struct soft *s, const struct shadow_input *in, struct error *err)
{
    char defines[64];
    const struct shadow_fit *fit = &s->maps.fit;
    snprintf(defines, sizeof defines, "MAPS %u\nMAP_PERSPECTIVE %d\n", fit->map_count, !fit->maps[0].orthographic);
    start_pass(s, in, &s->term, &s->radius);
    return shadow_run_full_screen(in, "soft_term.frag", defines, err);
}

static bool resolve_on_cpu(struct soft *s, const struct shadow_input *in, struct error *err)
{
    if (s->maps.fit.map_count == 0)
        return depth_pass_filter(&s->maps, in, DEPTH_ONE, NULL, 0, err);
    const struct soft_settings settings = {.radius = (float)light_radius(s, in),
                                           .near = (float)in->params[PARAM_NEAR],
                                           .far = (float)in->params[PARAM_FAR],
                                           .lift = (float)in->params[PARAM_LIFT]};
    return soft_pass_resolve(&s->on_cpu, &s->maps, in, &settings, err);
}

static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    struct soft *s = state;
    GLint visibility;
    if (in->resolve_on_cpu)
        return resolve_on_cpu(s, in, err);
    if (s->maps.fit.map_count == 0)
        return shadow_run_full_screen(in, "none.frag", NULL, err);
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &visibility);
    if (!reserve(s, in, err) || !bind(s, in, err) || !run_term(s, in, err))
        return false;
    start_pass(s, in, &s->blurred, NULL);
    gl_texture_bind(&s->term, UNIT_SOFT_TERM);
    if (!shadow_run_full_screen(in, "soft_blur.frag", "AXIS 0\n", err))
        return false;
    glBindFramebuffer(GL_FRAMEBUFFER, (GLuint)visibility);
    gl_texture_bind(&s->blurred, UNIT_SOFT_TERM);
    return shadow_run_full_screen(in, "soft_blur.frag", "AXIS 1\n", err);
}

static void finish(void *state)
{
    struct soft *s = state;
    light_maps_finish(&s->maps);
    soft_pass_finish(&s->on_cpu);
    map_ranges_finish(&s->ranges);
    gl_texture_finish(&s->term);
    gl_texture_finish(&s->radius);
    gl_texture_finish(&s->blurred);
    gl_target_finish(&s->target);
    gl_buffer_finish(&s->block);
}

static size_t bytes(const void *state)
{
    const struct soft *s = state;
    return light_maps_bytes(&s->maps) + soft_pass_bytes(&s->on_cpu) + map_ranges_bytes(&s->ranges) + s->term.bytes +
           s->radius.bytes + s->blurred.bytes + s->block.size;
}

const struct shadow_system shadow_soft = {
    .name = "soft",
    .title = "Distance-dependent soft shadows",
    .help = "Depth map; the shadow is blurred on the screen, the wider and lighter the farther its caster is away.",
    .lights = 1 << LIGHT_DIRECTIONAL | 1 << LIGHT_POINT | 1 << LIGHT_SPOT,
    .flags = SHADOW_USES_MAPS | SHADOW_BRIGHTENS | SHADOW_FILLS,
    .params = params,
    .param_count = sizeof params / sizeof *params,
    .state_size = sizeof(struct soft),
    .prepare = prepare,
    .resolve = resolve,
    .finish = finish,
    .bytes = bytes,
};
