#include "passes/camera.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/error.h"
#include "blocks.h"
#include "draw/draw_scene.h"
#include "gl/context.h"
#include "gl/program.h"
#include "passes/gbuffer.h"
#include "scene/pixel.h"
#include "trace/tracer.h"

bool camera_rasterize(struct gbuffer *g, struct draw_scene *scene, struct error *err)
{
    uint32_t width = g->ids.width, height = g->ids.height;
    if (!gl_texture_size(&g->depth, scene->gl, GL_DEPTH_COMPONENT32F, width, height, err))
        return false;
    g->traced = g->pixels_done = false;
    g->ids_uploaded = g->pixels_uploaded = true;
    if (!tiles_set_all(&g->tiles, width, height, err))
        return false;
    gl_target_attach(&g->target, &g->ids, &g->depth, 0);
    gl_target_bind(&g->target, width, height);
    static const GLuint nothing[4] = {NO_TRIANGLE, 0, 0, 0};
    static const GLfloat farthest = 0;
    glClearNamedFramebufferuiv(g->target.id, GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(g->target.id, GL_DEPTH, 0, &farthest);
    return draw_view_rasterize(&g->view, scene, DRAW_IDS, NULL, 0, err);
}

static bool reserve_cpu(struct gbuffer *g, struct error *err)
{
    size_t pixels = (size_t)g->ids.width * g->ids.height;
    if (g->cpu_room >= pixels)
        return true;
    free(g->cpu_ids);
    free(g->cpu_pixels);
    g->cpu_ids = malloc(pixels * sizeof *g->cpu_ids);
    g->cpu_pixels = malloc(pixels * sizeof *g->cpu_pixels);
    g->cpu_room = g->cpu_ids && g->cpu_pixels ? pixels : 0;
    return g->cpu_room ||
           error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a picture of %u x %u", g->ids.width, g->ids.height);
}

bool camera_trace(struct gbuffer *g, struct draw_scene *scene, const struct tracer *tracer, struct job_pool *pool,
                  struct error *err)
{
    if (!reserve_cpu(g, err))
        return false;
    g->traced = true;
    g->ids_uploaded = false;
    g->pixels_done = scene->plain;
    g->pixels_uploaded = !scene->plain;
    tracer_camera(tracer, &g->view.view, pool, g->cpu_ids, scene->plain ? g->cpu_pixels : NULL);
    return tiles_set_occupied(&g->tiles, g->cpu_ids, g->ids.width, g->ids.height, pool, err);
}

bool camera_surfaces(struct gbuffer *g, struct draw_scene *scene, struct error *err)
{
    if (g->pixels_done)
        return true;
    char defines[64];
    snprintf(defines, sizeof defines, "DISPLAY 0\n%s%s%s", scene->scene->texture_count ? "TEXTURES\n" : "",
             scene->scene->color_count ? "COLORS\n" : "", scene->has_emission ? "EMISSION\n" : "");
    struct gl_program *program = gl_programs_get(scene->gl->programs, "full_screen.vert", "surfaces.frag", defines, err);
    if (!program || !gbuffer_need_ids(g, scene->gl, err))
        return false;
    gl_target_attach_two(&g->target, &g->pixels, scene->has_emission ? &g->emission : NULL);
    gl_target_bind(&g->target, g->ids.width, g->ids.height);
    gl_program_use(program);
    gbuffer_bind(g, scene);
    static const GLuint nothing[4];
    glClearNamedFramebufferuiv(g->target.id, GL_COLOR, 0, nothing);
    tiles_draw(&g->tiles, scene->vertex_array);
    g->pixels_done = true;
    return gl_check(scene->gl, err);
}
