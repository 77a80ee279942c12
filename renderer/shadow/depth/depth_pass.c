#include "shadow/depth/depth_pass.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "passes/gbuffer.h"
#include "shadow/shared_params.h"

const struct depth_kernel *depth_kernel_choose(void)
{
#ifdef __x86_64__
    if (depth_avx512.filter && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
        return &depth_avx512;
    if (depth_avx2.filter && __builtin_cpu_supports("avx2"))
        return &depth_avx2;
#endif
    return &depth_plain;
}

size_t depth_job_count(const struct depth_job *job)
{
    return job->top < job->bottom ? (job->bottom - job->top + DEPTH_ROWS - 1) / DEPTH_ROWS : 0;
}

struct depth_map depth_map_of(const struct view *v, struct dvec3 camera_eye)
{
    const struct dvec3 axes[3] = {v->right, v->up, v->forward};
    double sx = v->width / (v->right_edge - v->left), sy = v->height / (v->top - v->bottom);
    struct depth_map m = {.scale_x = (float)sx,
                          .scale_y = (float)-sy,
                          .offset_x = (float)(-v->left * sx),
                          .offset_y = (float)(v->top * sy),
                          .near = (float)v->near,
                          .range = isinf(v->far) ? 0 : (float)v->far - (float)v->near,
                          .far = isinf(v->far) ? 0 : (float)v->far,
                          .texel = (float)fmax(1 / sx, 1 / sy)};
    for (int i = 0; i < 3; i++) {
        pixel_put(m.row[i], axes[i]);
        m.row[i][3] = (float)dvec3_dot(axes[i], dvec3_sub(camera_eye, v->eye));
    }
    return m;
}

bool depth_job_begin(struct depth_job *job, const struct shadow_input *in, struct error *err)
{
    *job = (struct depth_job){.pixels = gbuffer_read_pixels(in->gbuffer, in->draw, err),
                              .visibility = pixel_values(in, err),
                              .width = in->view->width,
                              .height = in->view->height,
                              .top = in->gbuffer->tiles.top,
                              .bottom = in->gbuffer->tiles.bottom,
                              .rays = pixel_rays_of(in->view),
                              .light = pixel_light_of(in->light, in->view->eye)};
    return job->pixels && job->visibility;
}

bool depth_job_init(struct depth_job *job, const struct light_maps *maps, const struct shadow_input *in, struct error *err)
{
    if (!depth_job_begin(job, in, err))
        return false;
    job->map_count = maps->fit.map_count;
    job->texels = maps->texels;
    job->bias = (float)in->params[SHADOW_PARAM_BIAS];
    job->slope = (float)in->params[SHADOW_PARAM_SLOPE];
    for (unsigned i = 0; i < maps->fit.map_count; i++)
        job->maps[i] = depth_map_of(&maps->fit.maps[i], in->view->eye);
    job->orthographic = maps->fit.maps[0].orthographic;
    job->side = (int32_t)maps->fit.maps[0].width;
    return true;
}

void depth_square_flat(struct depth_square *square, int side)
{
    memset(square, 0, sizeof *square);
    square->side = side;
    square->total = side * side;
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++)
            square->weight[y][x] = 1;
}

bool depth_pass_filter(const struct light_maps *maps, const struct shadow_input *in, enum depth_filter filter,
                       const struct depth_square *square, float umbra, struct error *err)
{
    struct depth_job job;
    if (!depth_job_init(&job, maps, in, err))
        return false;
    job.filter = filter;
    job.square = square;
    job.umbra = umbra;
    job_pool_for(in->pool, depth_job_count(&job), depth_kernel_choose()->filter, &job);
    return pixel_upload(in, job.visibility, err);
}

bool depth_pass_lit(const struct shadow_input *in, struct error *err)
{
    struct depth_job job;
    if (!depth_job_begin(&job, in, err))
        return false;
    job_pool_for(in->pool, depth_job_count(&job), depth_kernel_choose()->filter, &job);
    return pixel_upload(in, job.visibility, err);
}
