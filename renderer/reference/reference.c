#include "reference/reference.h"

#include <stdlib.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "reference/lines.h"

struct reference *reference_create(const struct scene *scene, unsigned threads, struct error *err)
{
    struct reference *r = calloc(1, sizeof *r);
    if (r) {
        r->scene = scene;
        if (candidates_build(r, threads))
            return r;
    }
    reference_destroy(r);
    error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the reference's tree of %zu triangles", scene->drawn_triangle_count);
    return NULL;
}

void reference_destroy(struct reference *r)
{
    if (!r)
        return;
    candidates_finish(r);
    free(r);
}

size_t reference_bytes(const struct reference *r)
{
    return sizeof *r + atomic_load(&r->embree_bytes) + r->scene->instance_count * sizeof *r->parts;
}

/* A picture cut into blocks; workers share it. */
struct picture_job {
    const struct reference *reference;
    const struct view *view;
    const struct light *light;
    const struct reference_progress *progress;
    uint32_t block_width, block_height;
    size_t block_count;
    void (*pixels)(struct picture_job *job, struct line_packet *packet, uint32_t x, uint32_t y);
    uint32_t step; /* pixels() does step x step of them */

    const uint32_t *ids; /* point */
    float *visibility;
    uint8_t *receiver;
    uint32_t *receivers, *lit; /* samples32 */
    uint8_t *one_triangle;

    atomic_size_t done;
    atomic_bool stop;
    atomic_ullong rays, tests, exact;
};

enum { BLOCK = 16 };

static void run_block(void *context, size_t index, unsigned worker)
{
    (void)worker;
    struct picture_job *job = context;
    const struct view *view = job->view;
    if (atomic_load(&job->stop))
        return;
    struct line_packet packet = {.reference = job->reference};
    size_t columns = (view->width + BLOCK - 1) / BLOCK;
    uint32_t x0 = (uint32_t)(index % columns) * BLOCK, y0 = (uint32_t)(index / columns) * BLOCK;
    for (uint32_t y = y0; y < y0 + BLOCK && y < view->height; y += job->step)
        for (uint32_t x = x0; x < x0 + BLOCK && x < view->width; x += job->step)
            job->pixels(job, &packet, x, y);
    atomic_fetch_add(&job->rays, packet.rays);
    atomic_fetch_add(&job->tests, packet.tests);
    atomic_fetch_add(&job->exact, packet.exact);
    size_t done = atomic_fetch_add(&job->done, 1) + 1;
    if (job->progress && job->progress->report &&
        !job->progress->report(job->progress->context, (double)done / (double)job->block_count))
        atomic_store(&job->stop, true);
}

static bool run(struct picture_job *job, struct job_pool *pool, struct reference_counts *counts)
{
    size_t columns = (job->view->width + BLOCK - 1) / BLOCK, rows = (job->view->height + BLOCK - 1) / BLOCK;
    job->block_count = columns * rows;
    job_pool_for(pool, job->block_count, run_block, job);
    if (counts)
        *counts = (struct reference_counts){atomic_load(&job->rays), atomic_load(&job->tests), atomic_load(&job->exact)};
    return !atomic_load(&job->stop) || atomic_load(&job->done) == job->block_count;
}

/* Four by four pixel centres whose triangles the camera pass found. */
static void point_pixels(struct picture_job *job, struct line_packet *packet, uint32_t x, uint32_t y)
{
    const struct view *view = job->view;
    unsigned active = 0;
    for (unsigned lane = 0; lane < LANES; lane++) {
        uint32_t px = x + lane % 4, py = y + lane / 4;
        if (px >= view->width || py >= view->height)
            continue;
        struct receiver *at = &packet->receiver[lane];
        at->id = job->ids[(size_t)py * view->width + px];
        view_ray(view, px + 0.5, py + 0.5, &at->origin, &at->direction);
        active |= (unsigned)lines_aim_at_light(packet, job->light, lane) << lane;
    }
    unsigned shadowed = active ? lines_find_shadowed(packet, job->light, active) : 0;
    packet->rays += (unsigned)__builtin_popcount(active);
    for (unsigned lane = 0; lane < LANES; lane++) {
        uint32_t px = x + lane % 4, py = y + lane / 4;
        if (px >= view->width || py >= view->height)
            continue;
        size_t at = (size_t)py * view->width + px;
        job->visibility[at] = (active & ~shadowed) >> lane & 1 ? 1.0f : 0.0f;
        if (job->receiver)
            job->receiver[at] = active >> lane & 1;
    }
}

bool reference_point(const struct reference *r, const struct view *view, const struct light *light, const uint32_t *ids,
                     struct job_pool *pool, const struct reference_progress *progress, float *visibility, uint8_t *receiver,
                     struct reference_counts *counts)
{
    struct picture_job job = {.reference = r,
                              .view = view,
                              .light = light,
                              .progress = progress,
                              .pixels = point_pixels,
                              .step = 4,
                              .ids = ids,
                              .visibility = visibility,
                              .receiver = receiver};
    return run(&job, pool, counts);
}

/* The 32 samples of one pixel, sixteen at a time. */
static void sample_pixel(struct picture_job *job, struct line_packet *packet, uint32_t x, uint32_t y)
{
    const struct view *view = job->view;
    uint32_t receivers = 0, lit = 0, first = SCENE_NONE;
    bool one = true;
    for (unsigned half = 0; half < 2; half++) {
        unsigned active = 0;
        for (unsigned lane = 0; lane < LANES; lane++) {
            const float *at = view_samples32[half * LANES + lane];
            view_ray(view, x + (double)at[0], y + (double)at[1], &packet->receiver[lane].origin,
                     &packet->receiver[lane].direction);
        }
        lines_find_visible(packet, view, (1u << LANES) - 1);
        if (half == 0)
            first = packet->receiver[0].id;
        for (unsigned lane = 0; lane < LANES; lane++) {
            one &= packet->receiver[lane].id == first;
            active |= (unsigned)lines_aim_at_light(packet, job->light, lane) << lane;
        }
        unsigned shadowed = active ? lines_find_shadowed(packet, job->light, active) : 0;
        receivers |= active << half * LANES;
        lit |= (active & ~shadowed) << half * LANES;
        packet->rays += LANES + (unsigned)__builtin_popcount(active);
    }
    size_t at = (size_t)y * view->width + x;
    job->receivers[at] = receivers;
    job->lit[at] = lit;
    if (job->one_triangle)
        job->one_triangle[at] = one && first != SCENE_NONE;
}

bool reference_samples32(const struct reference *r, const struct view *view, const struct light *light, struct job_pool *pool,
                         const struct reference_progress *progress, uint32_t *receivers, uint32_t *lit, uint8_t *one_triangle,
                         struct reference_counts *counts)
{
    struct picture_job job = {.reference = r,
                              .view = view,
                              .light = light,
                              .progress = progress,
                              .pixels = sample_pixel,
                              .step = 1,
                              .receivers = receivers,
                              .lit = lit,
                              .one_triangle = one_triangle};
    return run(&job, pool, counts);
}
