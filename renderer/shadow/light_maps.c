#include "shadow/light_maps.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "blocks.h"
#include "draw/draw_scene.h"
#include "draw/put_vec4.h"
#include "gl/context.h"
#include "trace/tracer.h"

static bool rasterize_map(struct light_maps *m, const struct shadow_input *in, unsigned layer, struct error *err)
{
    const struct view *view = &in->fit->maps[layer];
    static const GLfloat farthest = 0;
    gl_target_attach(&m->target, NULL, &m->depth, layer);
    gl_target_bind(&m->target, view->width, view->height);
    glClearNamedFramebufferfv(m->target.id, GL_DEPTH, 0, &farthest);
    return draw_view_set(&m->draw, in->draw, view, err) &&
           draw_view_rasterize(&m->draw, in->draw, DRAW_DEPTH, in->fit->casters, in->fit->caster_count, err);
}

struct encode_job {
    const struct view *view;
    float *texels;
};

void light_maps_encode(const struct view *v, float *texels, size_t count)
{
    float near = (float)v->near, scale = (float)(1 / (v->far - v->near)), far = (float)v->far;
    for (size_t i = 0; i < count; i++) {
        float d = v->orthographic ? (far - texels[i]) * scale : near / texels[i];
        texels[i] = isinf(texels[i]) ? 0 : fminf(fmaxf(d, 0), 1);
    }
}

static void encode_row(void *context, size_t row, unsigned worker)
{
    (void)worker;
    const struct encode_job *job = context;
    light_maps_encode(job->view, job->texels + row * job->view->width, job->view->width);
}

static bool trace_map(struct light_maps *m, const struct shadow_input *in, const struct tracer *tracer, unsigned layer,
                      float *texels, struct error *err)
{
    const struct view *view = &in->fit->maps[layer];
    tracer_light(tracer, view, in->fit->casters, in->fit->caster_count, in->pool, texels, NULL);
    struct encode_job job = {view, texels};
    job_pool_for(in->pool, view->height, encode_row, &job);
    glTextureSubImage3D(m->depth.id, 0, 0, 0, (GLint)layer, (GLsizei)view->width, (GLsizei)view->height, 1, GL_DEPTH_COMPONENT,
                        GL_FLOAT, texels);
    return gl_check(in->gl, err);
}

static bool trace_maps(struct light_maps *m, const struct shadow_input *in, struct error *err)
{
    const struct tracer *tracer = in->tracer(in->owner, err);
    if (!tracer)
        return false;
    const struct view *first = &in->fit->maps[0];
    float *texels = malloc((size_t)first->width * first->height * sizeof *texels);
    bool ok =
        texels || error_set(err, ERROR_TRY_AGAIN, "size", "out of memory for a map of %u x %u", first->width, first->height);
    for (unsigned i = 0; ok && i < in->fit->map_count; i++)
        ok = trace_map(m, in, tracer, i, texels, err);
    free(texels);
    return ok;
}

bool light_maps_prepare(void *maps, const struct shadow_input *in, struct error *err)
{
    struct light_maps *m = maps;
    m->fit = *in->fit;
    m->fit.casters = NULL;
    uint32_t size = in->fit->maps[0].width;
    unsigned count = in->fit->map_count;
    if (count == 0)
        return true;
    if (!gl_texture_size_layers(&m->depth, in->gl, GL_DEPTH_COMPONENT32F, size, size, count, err))
        return false;
    if (in->trace_maps)
        return trace_maps(m, in, err);
    for (unsigned i = 0; i < count; i++)
        if (!rasterize_map(m, in, i, err))
            return false;
    return true;
}

static void put_row(vec4 out, struct dvec3 axis, struct dvec3 from_map_eye)
{
    put_vec4(out, axis, dvec3_dot(axis, from_map_eye));
}

static void put_map(struct maps_block *block, unsigned i, const struct view *map, struct dvec3 camera_eye)
{
    struct dvec3 offset = dvec3_sub(camera_eye, map->eye);
    put_row(block->map_rows[3 * i], map->right, offset);
    put_row(block->map_rows[3 * i + 1], map->up, offset);
    put_row(block->map_rows[3 * i + 2], map->forward, offset);
    double sx = map->width / (map->right_edge - map->left), sy = map->height / (map->top - map->bottom);
    vec4 scale = {(float)sx, (float)-sy, (float)(-map->left * sx), (float)(map->top * sy)};
    vec4 depth = {(float)map->near, isinf(map->far) ? 0 : (float)map->far, 0, (float)fmax(1 / sx, 1 / sy)};
    memcpy(block->map_scale[i], scale, sizeof scale);
    memcpy(block->map_depth[i], depth, sizeof depth);
}

bool light_maps_bind(struct light_maps *m, const struct shadow_input *in, struct error *err)
{
    struct maps_block block = {0};
    for (unsigned i = 0; i < m->fit.map_count; i++)
        put_map(&block, i, &m->fit.maps[i], in->view->eye);
    block.map_counts[0] = m->fit.map_count;
    block.map_counts[1] = m->fit.maps[0].width;
    if (!gl_buffer_set(&m->block, in->gl, &block, sizeof block, 0, err))
        return false;
    glBindBufferBase(GL_UNIFORM_BUFFER, 3, m->block.id);
    gl_texture_bind(&m->depth, UNIT_SHADOW_MAP);
    return true;
}

size_t light_maps_bytes(const void *maps)
{
    const struct light_maps *m = maps;
    return m->depth.bytes + m->draw.rows.size + m->draw.commands.size + m->draw.block.size + m->block.size;
}

void light_maps_finish(void *maps)
{
    struct light_maps *m = maps;
    gl_texture_finish(&m->depth);
    gl_target_finish(&m->target);
    draw_view_finish(&m->draw);
    gl_buffer_finish(&m->block);
    memset(m, 0, sizeof *m);
}
