#include "passes/camera.h"

#include <epoxy/gl.h>
#include <stdlib.h>

#include "base/error.h"
#include "blocks.h"
#include "draw/draw_scene.h"
#include "gl/context.h"
#include "gl/program.h"
#include "passes/gbuffer.h"
#include "trace/tracer.h"

bool camera_rasterize(struct gbuffer *g, struct draw_scene *scene, struct error *err)
{
    uint32_t width = g->ids.width, height = g->ids.height;
    if (!gl_texture_size(&g->depth, scene->gl, GL_DEPTH_COMPONENT32F, width, height, err))
        return false;
    g->traced = false;
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
    if (g->cpu_pixels >= pixels)
        return true;
    free(g->cpu_ids);
    free(g->cpu_receivers);
    g->cpu_ids = malloc(pixels * sizeof *g->cpu_ids);
    g->cpu_receivers = malloc(pixels * 4 * sizeof *g->cpu_receivers);
    g->cpu_pixels = g->cpu_ids && g->cpu_receivers ? pixels : 0;
    return g->cpu_pixels || error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a picture of %u x %u", g->ids.width, g->ids.height);
}

bool camera_trace(struct gbuffer *g, struct draw_scene *scene, const struct tracer *tracer, struct job_pool *pool, struct error *err)
{
    if (!reserve_cpu(g, err))
        return false;
    g->traced = true;
    tracer_camera(tracer, &g->view.view, pool, g->cpu_ids, g->cpu_receivers);
    GLsizei width = (GLsizei)g->ids.width, height = (GLsizei)g->ids.height;
    glTextureSubImage2D(g->ids.id, 0, 0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, g->cpu_ids);
    glTextureSubImage2D(g->receivers.id, 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, g->cpu_receivers);
    return gl_check(scene->gl, err);
}

bool camera_receivers(struct gbuffer *g, struct draw_scene *scene, struct error *err)
{
    if (g->traced)
        return true;
    struct gl_program *program = gl_programs_get(scene->gl->programs, "full_screen.vert", "receivers.frag", NULL, err);
    if (!program)
        return false;
    gl_target_attach(&g->target, &g->receivers, NULL, 0);
    gl_target_bind(&g->target, g->ids.width, g->ids.height);
    gl_program_use(program);
    glBindVertexArray(scene->vertex_array);
    gbuffer_bind(g, scene);
    gl_draw_full_screen();
    return gl_check(scene->gl, err);
}
