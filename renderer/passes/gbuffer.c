#include "passes/gbuffer.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "blocks.h"
#include "draw/draw_scene.h"
#include "draw/put_vec4.h"
#include "gl/context.h"
#include "scene/pixel.h"
#include "scene/pixel_rays.h"

static uint32_t search_steps(size_t count)
{
    uint32_t steps = 0;
    while (((size_t)1 << steps) < count)
        steps++;
    return steps;
}

static bool upload_view(struct gbuffer *g, struct draw_scene *scene, struct error *err)
{
    const struct view *v = &g->view.view;
    const struct pixel_rays r = pixel_rays_of(v);
    struct view_block block = {0};
    memcpy(block.ray_origin, r.origin, sizeof r.origin);
    memcpy(block.ray_origin_dx, r.origin_dx, sizeof r.origin_dx);
    memcpy(block.ray_origin_dy, r.origin_dy, sizeof r.origin_dy);
    memcpy(block.ray_direction, r.direction, sizeof r.direction);
    memcpy(block.ray_direction_dx, r.direction_dx, sizeof r.direction_dx);
    memcpy(block.ray_direction_dy, r.direction_dy, sizeof r.direction_dy);
    put_vec4(block.view_forward, v->forward, (v->top - v->bottom) / v->height);
    put_vec4(block.view_clip, dvec3(v->near, isinf(v->far) ? 0 : v->far, v->orthographic), 0);
    uvec4 counts = {(uint32_t)scene->scene->instance_count, search_steps(scene->scene->instance_count), 0, 0};
    memcpy(block.view_counts, counts, sizeof counts);
    return gl_buffer_set(&g->view_block, scene->gl, &block, sizeof block, 0, err);
}

bool gbuffer_begin(struct gbuffer *g, struct draw_scene *scene, const struct view *view, struct error *err)
{
    g->pixels_read = false;
    return gl_texture_size(&g->ids, scene->gl, GL_R32UI, view->width, view->height, err) &&
           gl_texture_size(&g->pixels, scene->gl, GL_RGBA32UI, view->width, view->height, err) &&
           (!scene->has_emission || gl_texture_size(&g->emission, scene->gl, GL_RGBA16F, view->width, view->height, err)) &&
           draw_view_set(&g->view, scene, view, err) && upload_view(g, scene, err);
}

void gbuffer_finish(struct gbuffer *g)
{
    draw_view_finish(&g->view);
    gl_buffer_finish(&g->view_block);
    gl_texture_finish(&g->ids);
    gl_texture_finish(&g->pixels);
    gl_texture_finish(&g->emission);
    gl_texture_finish(&g->depth);
    tiles_finish(&g->tiles);
    gl_target_finish(&g->target);
    free(g->cpu_ids);
    free(g->cpu_pixels);
    free(g->read_pixels);
    free(g->values);
    memset(g, 0, sizeof *g);
}

void gbuffer_bind(struct gbuffer *g, const struct draw_scene *scene)
{
    if (!g->pixels_uploaded && g->tiles.top < g->tiles.bottom)
        glTextureSubImage2D(g->pixels.id, 0, 0, (GLint)g->tiles.top, (GLsizei)g->ids.width,
                            (GLsizei)(g->tiles.bottom - g->tiles.top), GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                            g->cpu_pixels + (size_t)g->tiles.top * g->ids.width);
    g->pixels_uploaded = true;
    draw_scene_bind(scene);
    gl_buffer_bind_texture(&g->view.rows, UNIT_ROWS);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, g->view_block.id);
    gl_texture_bind(&g->ids, UNIT_IDS);
    gl_texture_bind(&g->pixels, UNIT_PIXELS);
    gl_texture_bind(&g->emission, UNIT_EMISSION);
}

bool gbuffer_need_ids(struct gbuffer *g, struct gl_context *gl, struct error *err)
{
    if (!g->ids_uploaded)
        glTextureSubImage2D(g->ids.id, 0, 0, 0, (GLsizei)g->ids.width, (GLsizei)g->ids.height, GL_RED_INTEGER, GL_UNSIGNED_INT,
                            g->cpu_ids);
    g->ids_uploaded = true;
    return gl_check(gl, err);
}

const uint32_t *gbuffer_read_ids(struct gbuffer *g, struct gl_context *gl, struct error *err)
{
    size_t pixels = (size_t)g->ids.width * g->ids.height;
    if (g->traced)
        return g->cpu_ids;
    uint32_t *ids = realloc(g->cpu_ids, pixels * sizeof *ids);
    if (!ids) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a picture's ids");
        return NULL;
    }
    g->cpu_ids = ids;
    g->cpu_room = 0;
    glGetTextureImage(g->ids.id, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, (GLsizei)(pixels * sizeof *ids), ids);
    return gl_check(gl, err) ? ids : NULL;
}

/* Room for `size` bytes a pixel; what was there is lost when it grows. */
static void *picture_room(const struct gbuffer *g, void *old, size_t *room, size_t size, struct error *err)
{
    size_t pixels = (size_t)g->ids.width * g->ids.height;
    if (*room >= pixels)
        return old;
    free(old);
    void *grown = malloc(pixels * size);
    *room = grown ? pixels : 0;
    if (!grown)
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a picture of %u x %u", g->ids.width, g->ids.height);
    return grown;
}

const struct pixel *gbuffer_read_pixels(struct gbuffer *g, struct draw_scene *scene, struct error *err)
{
    uint32_t width = g->pixels.width, height = g->pixels.height, top = g->tiles.top, bottom = g->tiles.bottom;
    if (g->traced && scene->plain)
        return g->cpu_pixels;
    g->read_pixels = picture_room(g, g->read_pixels, &g->read_room, sizeof *g->read_pixels, err);
    if (!g->read_pixels || g->pixels_read)
        return g->read_pixels;
    if (top >= bottom)
        top = bottom = height;
    size_t row = width * sizeof *g->read_pixels;
    memset(g->read_pixels, 0, top * row);
    memset(g->read_pixels + (size_t)bottom * width, 0, (height - bottom) * row);
    if (top < bottom)
        glGetTextureSubImage(g->pixels.id, 0, 0, (GLint)top, 0, (GLsizei)width, (GLsizei)(bottom - top), 1, GL_RGBA_INTEGER,
                             GL_UNSIGNED_INT, (GLsizei)((bottom - top) * row), g->read_pixels + (size_t)top * width);
    g->pixels_read = gl_check(scene->gl, err);
    return g->pixels_read ? g->read_pixels : NULL;
}

float *gbuffer_values(struct gbuffer *g, struct error *err)
{
    return g->values = picture_room(g, g->values, &g->value_room, sizeof *g->values, err);
}
