#include "passes/lighting_pixels.h"

#include "base/job_pool.h"

enum { ROWS = 8 }; /* a job */

struct rows_job {
    const struct lighting_pixels *lighting;
    lighting_row *row;
    uint32_t background;
};

static lighting_row *choose_row(void)
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2"))
        return lighting_row_avx2;
#endif
    return lighting_row_plain;
}

static void fill_rows(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct rows_job *job = context;
    const struct lighting_pixels *l = job->lighting;
    for (uint32_t y = (uint32_t)index * ROWS; y < l->height && y < (index + 1) * ROWS; y++) {
        if (y >= l->top && y < l->bottom) {
            job->row(l, y, job->background);
            continue;
        }
        for (uint32_t x = 0; x < l->width; x++)
            l->picture[(size_t)y * l->width + x] = job->background;
    }
}

static uint32_t pack(const float color[4])
{
    uint32_t out = 0;
    for (int i = 0; i < 4; i++)
        out |= pixel_unorm8(color[i]) << 8 * i;
    return out;
}

void lighting_pixels_run(const struct lighting_pixels *job, struct job_pool *pool)
{
    struct rows_job rows = {job, choose_row(), pack(job->lights->background)};
    job_pool_for(pool, (job->height + ROWS - 1) / ROWS, fill_rows, &rows);
}
