#include "shadow/depth/soft_pass.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "base/lanes.h"

static bool out_of_memory(struct error *err) { return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for soft shadows"); }

bool soft_pass_prepare(struct soft_pass *s, const struct light_maps *maps, const struct shadow_input *in, uint32_t block,
                       struct error *err)
{
    unsigned level = 0;
    while (BOUND_SIDE << level < (int)block && level < BOUND_LEVELS - 1)
        level++;
    return map_bounds_prepare(&s->bounds, maps->texels, maps->fit.maps[0].width, maps->fit.map_count, level, in->pool, err);
}

static void drop_pixels(struct soft_pass *s)
{
    free(s->terms);
    free(s->sigmas);
    free(s->blurs);
    s->terms = NULL;
    s->sigmas = NULL;
    s->blurs = NULL;
    s->pixel_room = 0;
}

static void drop_bands(struct soft_pass *s)
{
    free(s->band_terms);
    free(s->band_sigmas);
    s->band_terms = NULL;
    s->band_sigmas = NULL;
    s->band_room = 0;
}

/* Of the largest picture seen: views of several sizes take turns. */
static bool reserve_pixels(struct soft_pass *s, size_t pixels, struct error *err)
{
    if (s->pixel_room >= pixels)
        return true;
    drop_pixels(s);
    s->terms = malloc(pixels * sizeof *s->terms);
    s->sigmas = malloc(pixels * sizeof *s->sigmas);
    s->blurs = malloc(pixels / LANES);
    if (!s->terms || !s->sigmas || !s->blurs)
        return out_of_memory(err);
    s->pixel_room = pixels;
    return true;
}

static bool reserve_bands(struct soft_pass *s, size_t pixels, struct error *err)
{
    if (s->band_room >= pixels)
        return true;
    drop_bands(s);
    s->band_terms = malloc(pixels * sizeof *s->band_terms);
    s->band_sigmas = malloc(pixels * sizeof *s->band_sigmas);
    if (!s->band_terms || !s->band_sigmas)
        return out_of_memory(err);
    s->band_room = pixels;
    return true;
}

bool soft_pass_resolve(struct soft_pass *s, const struct light_maps *maps, const struct shadow_input *in,
                       const struct soft_settings *settings, struct error *err)
{
    const struct view *v = in->view;
    struct soft_job job = {
        .settings = *settings, .pass = s, .parallel = v->orthographic, .grain = (float)((v->top - v->bottom) / v->height)};
    const struct depth_kernel *kernel = depth_kernel_choose();
    s->stride = (v->width + LANES - 1) / LANES * LANES;
    size_t band = job_pool_threads(in->pool) * DEPTH_ROWS * s->stride;
    if (!reserve_pixels(s, (size_t)s->stride * v->height, err) || !reserve_bands(s, band, err) ||
        !depth_job_init(&job.depth, maps, in, err))
        return false;
    job.depth.bounds = &s->bounds;
    job_pool_for(in->pool, depth_job_count(&job.depth), kernel->soft_term, &job);
    job_pool_for(in->pool, depth_job_count(&job.depth), kernel->soft_blur, &job);
    return pixel_upload(in, job.depth.visibility, err);
}

void soft_pass_finish(struct soft_pass *s)
{
    drop_pixels(s);
    drop_bands(s);
    map_bounds_finish(&s->bounds);
    memset(s, 0, sizeof *s);
}

size_t soft_pass_bytes(const struct soft_pass *s)
{
    return s->pixel_room * (sizeof *s->terms + sizeof *s->sigmas) + s->pixel_room / LANES +
           s->band_room * (sizeof *s->band_terms + sizeof *s->band_sigmas) + s->bounds.bytes;
}
