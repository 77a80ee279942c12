#include "passes/lighting.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "blocks.h"
#include "draw/draw_scene.h"
#include "draw/put_vec4.h"
#include "gl/context.h"
#include "gl/program.h"
#include "passes/gbuffer.h"
#include "passes/lighting_pixels.h"
#include "passes/visibility.h"

_Static_assert(LIGHT_DIRECTIONAL == LIGHT_KIND_DIRECTIONAL && LIGHT_POINT == LIGHT_KIND_POINT && LIGHT_SPOT == LIGHT_KIND_SPOT,
               "blocks.h");

double lighting_illuminance(const struct scene *scene, const struct light *lights, size_t light_count)
{
    struct dvec3 centre = dbox_center(&scene->bounds);
    double radius = dbox_radius(&scene->bounds), sum = 0;
    if (dbox_is_empty(&scene->bounds))
        centre = dvec3(0, 0, 0);
    for (size_t i = 0; i < light_count; i++) {
        const struct light *l = &lights[i];
        double peak = fmax(l->color[0], fmax(l->color[1], l->color[2])) * l->intensity;
        struct dvec3 v = dvec3_sub(l->position, centre);
        /* A light inside the scene: not nearer than a tenth of its size. */
        double d2 = fmax(dvec3_dot(v, v), 0.01 * radius * radius);
        sum += l->kind == LIGHT_DIRECTIONAL ? peak : d2 > 0 ? peak / d2 : 0;
    }
    return sum;
}

/* KHR_lights_punctual, "Inner and Outer Cone Angles". */
static void put_cone(vec4 out, const struct light *l)
{
    double scale = 1 / fmax(0.001, cos(l->inner) - cos(l->outer));
    put_vec4(out, dvec3(scale, -cos(l->outer) * scale, 0), 0);
}

/* A neutral dark grey behind everything, as shown: no exposure, no tone curve. */
static const float *background_of(const struct lighting_input *in)
{
    static const float linear[4] = {0.012f, 0.013f, 0.015f, 1}, srgb[4] = {0.112f, 0.117f, 0.126f, 1};
    return in->display == LIGHTING_LINEAR ? linear : srgb;
}

static struct lights_block block_of(const struct lighting_input *in)
{
    struct lights_block block = {0};
    struct dvec3 eye = in->gbuffer->view.view.eye;
    for (size_t i = 0; i < in->light_count; i++) {
        const struct light *l = &in->lights[i];
        put_vec4(block.lights_position[i], dvec3_sub(l->position, eye), l->kind);
        put_vec4(block.lights_direction[i], l->direction,
                 l->kind != LIGHT_DIRECTIONAL && l->range > 0 ? 1 / (l->range * l->range) : 0);
        put_vec4(block.lights_color[i], dvec3_scale(dvec3_from_float(l->color), l->intensity), 0);
        put_cone(block.lights_cone[i], l);
    }
    double unit = dbox_radius(&in->scene->scene->bounds);
    put_vec4(block.picture, dvec3(in->exposure, in->ambient, in->aa_side), unit > 0 ? unit : 1);
    memcpy(block.background, background_of(in), sizeof block.background);
    return block;
}

/* What all lights are; -1 if they differ. */
static int common_kind(const struct lighting_input *in)
{
    for (size_t i = 1; i < in->light_count; i++)
        if (in->lights[i].kind != in->lights[0].kind)
            return -1;
    return in->light_count ? (int)in->lights[0].kind : -1;
}

/* Depths, normals and ids are shown as they are: they are no light. */
static enum lighting_display display_of(const struct lighting_input *in)
{
    bool light = in->show == LIGHTING_SHADED || in->show == LIGHTING_VISIBILITY;
    return light ? in->display : LIGHTING_LINEAR;
}

static struct gl_program *lighting_program(const struct lighting_input *in, struct error *err)
{
    char defines[160];
    snprintf(defines, sizeof defines, "SHOW %d\nDISPLAY %d\nLIGHTS %zu\nKINDS %d\nRESOLVE_LATER %d\n%s", in->show, display_of(in),
             in->light_count, common_kind(in), in->aa_side > 1, in->scene->has_emission ? "EMISSION\n" : "");
    return gl_programs_get(in->scene->gl->programs, "full_screen.vert", "lighting.frag", defines, err);
}

static bool downsample(struct lighting *l, const struct lighting_input *in, struct error *err)
{
    char defines[32];
    snprintf(defines, sizeof defines, "DISPLAY %d\n", display_of(in));
    struct gl_program *program = gl_programs_get(in->scene->gl->programs, "full_screen.vert", "downsample.frag", defines, err);
    if (!program)
        return false;
    gl_target_attach(&l->target, &l->result, NULL, 0);
    gl_target_bind(&l->target, l->result.width, l->result.height);
    gl_program_use(program);
    glBindVertexArray(in->scene->vertex_array);
    gl_texture_bind(&l->samples, UNIT_PICTURE);
    gl_draw_full_screen();
    return true;
}

bool lighting_fits_cpu(const struct lighting_input *in)
{
    return in->show == LIGHTING_SHADED && in->display != LIGHTING_LINEAR && in->aa_side == 1 && !in->scene->has_emission;
}

static bool reserve_picture(struct lighting *l, size_t pixels, struct error *err)
{
    if (l->room >= pixels)
        return true;
    free(l->picture);
    l->picture = malloc(pixels * sizeof *l->picture);
    l->room = l->picture ? pixels : 0;
    return l->picture || error_set(err, ERROR_TRY_AGAIN, "size", "out of memory for a picture of %zu pixels", pixels);
}

static bool run_on_cpu(struct lighting *l, const struct lighting_input *in, struct error *err)
{
    struct gl_context *gl = in->scene->gl;
    uint32_t width = in->gbuffer->ids.width, height = in->gbuffer->ids.height;
    const struct lights_block block = block_of(in);
    struct lighting_pixels job = {.width = width,
                                  .height = height,
                                  .top = in->gbuffer->tiles.top,
                                  .bottom = in->gbuffer->tiles.bottom,
                                  .rays = pixel_rays_of(&in->gbuffer->view.view),
                                  .lights = &block,
                                  .light_count = in->light_count,
                                  .aces = in->display == LIGHTING_ACES};
    if (!gl_texture_size(&l->result, gl, GL_RGBA8, width, height, err) || !reserve_picture(l, (size_t)width * height, err) ||
        !(job.pixels = gbuffer_read_pixels(in->gbuffer, in->scene, err)))
        return false;
    job.picture = l->picture;
    for (size_t i = 0; i < in->light_count; i++)
        job.visibility[i] = in->visibility->layers[i].values;
    lighting_pixels_run(&job, in->pool);
    glTextureSubImage2D(l->result.id, 0, 0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA, GL_UNSIGNED_BYTE, l->picture);
    gl_target_attach(&l->target, &l->result, NULL, 0);
    gl_target_bind(&l->target, width, height);
    return gl_check(gl, err);
}

bool lighting_run(struct lighting *l, const struct lighting_input *in, struct error *err)
{
    struct gl_context *gl = in->scene->gl;
    uint32_t width = in->gbuffer->ids.width, height = in->gbuffer->ids.height;
    static const float nothing[4];
    bool many = in->aa_side > 1;
    bool linear = in->display == LIGHTING_LINEAR;
    if (lighting_fits_cpu(in) && in->visibility->layers[0].values)
        return visibility_need_values(in->visibility, gl, err) && run_on_cpu(l, in, err);
    GLenum format = linear ? GL_RGBA32F : GL_RGBA8, samples_format = linear ? GL_RGBA32F : GL_RGBA16F;
    const struct lights_block block = block_of(in);
    if (!gl_texture_size(&l->result, gl, format, width / in->aa_side, height / in->aa_side, err) ||
        (many && !gl_texture_size(&l->samples, gl, samples_format, width, height, err)) ||
        !gl_buffer_set(&l->block, gl, &block, sizeof block, 0, err) || !visibility_need_texture(in->visibility, gl, err))
        return false;
    struct gl_program *program = lighting_program(in, err);
    if (!program)
        return false;
    if (in->show == LIGHTING_ID && !gbuffer_need_ids(in->gbuffer, gl, err))
        return false;
    gl_target_attach(&l->target, many ? &l->samples : &l->result, NULL, 0);
    gl_target_bind(&l->target, width, height);
    gl_program_use(program);
    gbuffer_bind(in->gbuffer, in->scene);
    gl_texture_bind(&in->visibility->texture, UNIT_VISIBILITY);
    glBindBufferBase(GL_UNIFORM_BUFFER, 5, l->block.id);
    glClearNamedFramebufferfv(l->target.id, GL_COLOR, 0, many ? nothing : background_of(in));
    tiles_draw(&in->gbuffer->tiles, in->scene->vertex_array);
    return (!many || downsample(l, in, err)) && gl_check(gl, err);
}

void lighting_finish(struct lighting *l)
{
    gl_buffer_finish(&l->block);
    gl_texture_finish(&l->samples);
    gl_texture_finish(&l->result);
    gl_target_finish(&l->target);
    free(l->picture);
    memset(l, 0, sizeof *l);
}
