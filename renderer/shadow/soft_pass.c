#include "shadow/soft_pass.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"

struct range_job {
    const struct soft_pass *pass;
    const float *texels;
    uint32_t side; /* of a map, texels */
};

/* Nearest and farthest of the texels in column [x, end) and rows [y, y_end). */
static void range_of(const struct range_job *job, const float *map, uint32_t x, uint32_t end, uint32_t y, uint32_t y_end,
                     float out[2])
{
    float high[4] = {0, 0, 0, 0}, low[4] = {1, 1, 1, 1};
    for (; y < y_end; y++) {
        const float *row = map + (size_t)y * job->side;
        for (uint32_t i = x; i < end; i++) {
            float t = row[i];
            high[i % 4] = t > high[i % 4] ? t : high[i % 4];
            low[i % 4] = t < low[i % 4] ? t : low[i % 4];
        }
    }
    for (int i = 1; i < 4; i++) {
        high[0] = high[i] > high[0] ? high[i] : high[0];
        low[0] = low[i] < low[0] ? low[i] : low[0];
    }
    out[0] = high[0];
    out[1] = low[0];
}

/* A row of blocks, of all maps' rows. */
static void range_row(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct range_job *job = context;
    const struct soft_pass *s = job->pass;
    uint32_t row = (uint32_t)(index % s->blocks), y = row * s->block, y_end = y + s->block < job->side ? y + s->block : job->side;
    const float *map = job->texels + index / s->blocks * job->side * job->side;
    float *out = s->own + 2 * index * s->blocks;
    for (uint32_t i = 0; i < s->blocks; i++) {
        uint32_t x = i * s->block, end = x + s->block < job->side ? x + s->block : job->side;
        range_of(job, map, x, end, y, y_end, out + 2 * (size_t)i);
    }
}

/* And of the eight blocks around. */
static void widen_row(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct range_job *job = context;
    const struct soft_pass *s = job->pass;
    int32_t last = (int32_t)s->blocks - 1, row = (int32_t)(index % s->blocks);
    const float *map = s->own + 2 * (index - (size_t)row) * s->blocks;
    for (int32_t i = 0; i <= last; i++) {
        float high = 0, low = 1;
        for (int32_t y = row > 0 ? row - 1 : 0; y <= (row < last ? row + 1 : last); y++)
            for (int32_t x = i > 0 ? i - 1 : 0; x <= (i < last ? i + 1 : last); x++) {
                const float *r = map + 2 * ((size_t)y * s->blocks + (size_t)x);
                high = r[0] > high ? r[0] : high;
                low = r[1] < low ? r[1] : low;
            }
        float *out = s->ranges + 2 * (index * s->blocks + (size_t)i);
        out[0] = high;
        out[1] = low;
    }
}

static bool out_of_memory(struct error *err) { return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for soft shadows"); }

bool soft_pass_prepare(struct soft_pass *s, const struct light_maps *maps, const struct shadow_input *in, uint32_t block,
                       struct error *err)
{
    struct range_job job = {s, maps->texels, maps->fit.maps[0].width};
    s->block = block;
    s->blocks = (job.side + block - 1) / block;
    size_t count = 2 * (size_t)maps->fit.map_count * s->blocks * s->blocks;
    if (s->range_room < count) {
        free(s->ranges);
        free(s->own);
        s->ranges = malloc(count * sizeof *s->ranges);
        s->own = malloc(count * sizeof *s->own);
        s->range_room = s->ranges && s->own ? count : 0;
        if (!s->range_room)
            return out_of_memory(err);
    }
    job_pool_for(in->pool, (size_t)maps->fit.map_count * s->blocks, range_row, &job);
    job_pool_for(in->pool, (size_t)maps->fit.map_count * s->blocks, widen_row, &job);
    return true;
}

static void drop_pixels(struct soft_pass *s)
{
    free(s->terms);
    free(s->blurred);
    free(s->sigmas[0]);
    free(s->sigmas[1]);
    s->terms = s->blurred = NULL;
    s->sigmas[0] = s->sigmas[1] = NULL;
    s->pixel_room = 0;
}

/* Of the largest picture seen: views of several sizes take turns. */
static bool reserve(struct soft_pass *s, size_t pixels, struct error *err)
{
    if (s->pixel_room >= pixels)
        return true;
    drop_pixels(s);
    s->terms = malloc(pixels * sizeof *s->terms);
    s->blurred = malloc(pixels * sizeof *s->blurred);
    for (int i = 0; i < 2; i++)
        s->sigmas[i] = malloc(pixels * sizeof *s->sigmas[i]);
    if (!s->terms || !s->blurred || !s->sigmas[0] || !s->sigmas[1])
        return out_of_memory(err);
    s->pixel_room = pixels;
    return true;
}

bool soft_pass_resolve(struct soft_pass *s, const struct light_maps *maps, const struct shadow_input *in,
                       const struct soft_settings *settings, struct error *err)
{
    const struct view *v = in->view;
    struct soft_job job = {
        .settings = *settings, .pass = s, .parallel = v->orthographic, .grain = (float)((v->top - v->bottom) / v->height)};
    const struct depth_kernel *kernel = depth_kernel_choose();
    if (!reserve(s, (size_t)v->width * v->height, err) || !depth_job_init(&job.depth, maps, in, err))
        return false;
    size_t all = (job.depth.height + DEPTH_ROWS - 1) / DEPTH_ROWS, some = depth_job_count(&job.depth);
    job_pool_for(in->pool, all, kernel->soft_term, &job);
    job_pool_for(in->pool, some, kernel->soft_blur_x, &job);
    job_pool_for(in->pool, some, kernel->soft_blur_y, &job);
    return pixel_upload(in, job.depth.visibility, err);
}

void soft_pass_finish(struct soft_pass *s)
{
    drop_pixels(s);
    free(s->ranges);
    free(s->own);
    memset(s, 0, sizeof *s);
}

size_t soft_pass_bytes(const struct soft_pass *s)
{
    return s->pixel_room * (2 * sizeof *s->terms + 2 * sizeof *s->sigmas[0]) + s->range_room * 2 * sizeof *s->ranges;
}
