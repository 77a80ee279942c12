#include "shadow/depth/light_maps.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "base/lanes.h"
#include "blocks.h"
#include "draw/draw_scene.h"
#include "draw/producer.h"
#include "draw/put_vec4.h"
#include "gl/context.h"
#include "shadow/depth/depth_pass.h"
#include "trace/tracer.h"

static bool rasterize_map(struct light_maps *m, const struct shadow_input *in, unsigned map, unsigned layer, struct error *err)
{
    const struct view *view = &in->fit->maps[map];
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

/* INFINITY becomes 0 by itself. */
void light_maps_encode(const struct view *v, float *texels, size_t count)
{
    float near = (float)v->near, scale = (float)(1 / (v->far - v->near)), far = (float)v->far;
    size_t i = 0;
    for (; i + LANES <= count; i += LANES) {
        lanes depth = lanes_load(texels + i), d = v->orthographic ? (far - depth) * scale : near / depth;
        lanes_store(texels + i, lanes_min(lanes_max(d, lanes_all(0)), lanes_all(1)));
    }
    for (; i < count; i++) {
        float d = v->orthographic ? (far - texels[i]) * scale : near / texels[i];
        texels[i] = d > 1 ? 1 : d > 0 ? d : 0;
    }
}

static void encode_row(void *context, size_t row, unsigned worker)
{
    (void)worker;
    const struct encode_job *job = context;
    light_maps_encode(job->view, job->texels + row * job->view->width, job->view->width);
}

static void trace_map(const struct shadow_input *in, const struct tracer *tracer, unsigned map, float *texels)
{
    const struct view *view = &in->fit->maps[map];
    tracer_light(tracer, view, in->fit->casters, in->fit->caster_count, in->pool, texels, NULL);
    struct encode_job job = {view, texels};
    job_pool_for(in->pool, view->height, encode_row, &job);
}

static size_t texels_of(const struct light_maps *m) { return (size_t)m->fit.maps[0].width * m->fit.maps[0].height; }

static bool reserve(struct light_maps *m, unsigned maps, struct error *err)
{
    size_t count = maps * texels_of(m) + LIGHT_MAPS_PAST;
    if (m->texel_room == count)
        return true;
    free(m->texels);
    m->texels = malloc(count * sizeof *m->texels);
    m->texel_room = m->texels ? count : 0;
    if (!m->texels)
        return error_set(err, ERROR_TRY_AGAIN, "size", "out of memory for %u maps of %u x %u", maps, m->fit.maps[0].width,
                         m->fit.maps[0].height);
    memset(m->texels + count - LIGHT_MAPS_PAST, 0, LIGHT_MAPS_PAST * sizeof *m->texels);
    return true;
}

static bool size_texture(struct light_maps *m, const struct shadow_input *in, unsigned layers, struct error *err)
{
    return gl_texture_size_layers(&m->depth, in->gl, GL_DEPTH_COMPONENT32F, m->fit.maps[0].width, m->fit.maps[0].height, layers,
                                  err);
}

static void drop_texels(struct light_maps *m)
{
    free(m->texels);
    m->texels = NULL;
    m->texel_room = 0;
}

static void begin(struct light_maps *m, const struct shadow_input *in)
{
    m->fit = *in->fit;
    m->fit.casters = NULL;
}

static bool trace_on_gpu(struct light_maps *m, const struct shadow_input *in, struct error *err)
{
    const struct tracer *tracer = in->tracer(in->owner, err);
    const struct view *view = &in->fit->maps[0];
    if (!tracer || !reserve(m, 1, err))
        return false;
    for (unsigned i = 0; i < m->fit.map_count; i++) {
        trace_map(in, tracer, i, m->texels);
        glTextureSubImage3D(m->depth.id, 0, 0, 0, (GLint)i, (GLsizei)view->width, (GLsizei)view->height, 1, GL_DEPTH_COMPONENT,
                            GL_FLOAT, m->texels);
    }
    drop_texels(m);
    return gl_check(in->gl, err);
}

static bool prepare_on_gpu(struct light_maps *m, const struct shadow_input *in, struct error *err)
{
    begin(m, in);
    if (m->fit.map_count == 0)
        return true;
    if (!size_texture(m, in, m->fit.map_count, err))
        return false;
    if (in->trace_maps)
        return trace_on_gpu(m, in, err);
    for (unsigned i = 0; i < m->fit.map_count; i++)
        if (!rasterize_map(m, in, i, i, err))
            return false;
    return true;
}

/* What the CPU's rasterizer leaves is GL's, or the tracer's where that is faster. */
static bool rasterize_to(struct light_maps *m, const struct shadow_input *in, unsigned map, float *texels, struct error *err)
{
    bool done = false;
    if (in->resolve_on_cpu && !map_raster_draw(&m->raster, in->scene, &in->fit->maps[map], in->fit->casters,
                                               in->fit->caster_count, depth_kernel_choose(), in->pool, texels, &done, err))
        return false;
    if (done)
        return true;
    if (in->resolve_on_cpu && producer_traces_map(in->draw, texels_of(m))) {
        const struct tracer *tracer = in->tracer(in->owner, err);
        if (tracer)
            trace_map(in, tracer, map, texels);
        return tracer;
    }
    if (!size_texture(m, in, 1, err) || !rasterize_map(m, in, map, 0, err))
        return false;
    glGetTextureImage(m->depth.id, 0, GL_DEPTH_COMPONENT, GL_FLOAT, (GLsizei)(texels_of(m) * sizeof *texels), texels);
    return true;
}

bool light_maps_prepare_on_cpu(struct light_maps *m, const struct shadow_input *in, struct error *err)
{
    begin(m, in);
    if (m->fit.map_count == 0)
        return true;
    const struct tracer *tracer = in->trace_maps ? in->tracer(in->owner, err) : NULL;
    if ((in->trace_maps && !tracer) || !reserve(m, m->fit.map_count, err))
        return false;
    for (unsigned i = 0; i < m->fit.map_count; i++) {
        float *texels = m->texels + i * texels_of(m);
        if (tracer)
            trace_map(in, tracer, i, texels);
        else if (!rasterize_to(m, in, i, texels, err))
            return false;
    }
    return gl_check(in->gl, err);
}

bool light_maps_prepare(void *maps, const struct shadow_input *in, struct error *err)
{
    return in->resolve_on_cpu ? light_maps_prepare_on_cpu(maps, in, err) : prepare_on_gpu(maps, in, err);
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
    return m->depth.bytes + m->texel_room * sizeof *m->texels + map_raster_bytes(&m->raster) + m->draw.rows.size +
           m->draw.commands.size + m->draw.block.size + m->block.size;
}

void light_maps_finish(void *maps)
{
    struct light_maps *m = maps;
    gl_texture_finish(&m->depth);
    gl_target_finish(&m->target);
    draw_view_finish(&m->draw);
    gl_buffer_finish(&m->block);
    drop_texels(m);
    map_raster_finish(&m->raster);
    memset(m, 0, sizeof *m);
}
