#include "exact/exact_shadows.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "exact/tile.h"

struct exact_shadows {
    struct triangles triangles;
    struct light light;
    struct light_grid grid;
    struct bins bins;
    struct tile_scratch *scratch;
    unsigned scratch_count;
    float *visibility;
    uint32_t *receivers, *lit;
    size_t pixel_room, mask_room;
    size_t memory;
    bool plain;
    struct tile_counts counts; /* of the last picture */
};

struct exact_shadows *exact_shadows_create(const struct scene *scene, size_t memory, struct error *err)
{
    struct exact_shadows *e = calloc(1, sizeof *e);
    if (!e || !triangles_init(&e->triangles, scene)) {
        exact_shadows_destroy(e);
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for exact shadows of %zu triangles", scene->drawn_triangle_count);
        return NULL;
    }
    e->memory = memory;
    return e;
}

static void free_scratch(struct exact_shadows *e)
{
    for (unsigned i = 0; i < e->scratch_count; i++)
        free(e->scratch[i].order);
    free(e->scratch);
}

void exact_shadows_destroy(struct exact_shadows *e)
{
    if (!e)
        return;
    triangles_finish(&e->triangles);
    light_grid_finish(&e->grid);
    bins_finish(&e->bins);
    free_scratch(e);
    free(e->visibility);
    free(e->receivers);
    free(e->lit);
    free(e);
}

bool exact_shadows_set_light(struct exact_shadows *e, const struct light *light, struct job_pool *pool, struct error *err)
{
    size_t own = triangles_bytes(e->triangles.scene), least = light_grid_least_bytes(&e->triangles);
    light_grid_finish(&e->grid);
    e->light = *light;
    if (e->memory && e->memory < own + least)
        return error_set(err, ERROR_TRY_AGAIN, NULL,
                         "exact shadows of %u triangles need at least %zu MiB a light, %zu were allowed", e->triangles.count,
                         (own + least) / 1048576 + 1, e->memory / 1048576);
    return light_grid_init(&e->grid, &e->triangles, light, e->memory ? e->memory - own : 0, pool) ||
           error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the light's grid of %u triangles", e->triangles.count);
}

static const struct tile_kernel *kernel_for(const struct exact_shadows *e)
{
#ifdef __x86_64__
    if (!e->plain && tile_avx512.point && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
        return &tile_avx512;
    if (!e->plain && tile_avx2.point && __builtin_cpu_supports("avx2"))
        return &tile_avx2;
#endif
    (void)e;
    return &tile_plain;
}

static bool reserve(struct exact_shadows *e, size_t pixels, bool masks, unsigned threads)
{
    if (e->pixel_room < pixels) {
        free(e->visibility);
        e->visibility = malloc(pixels * sizeof *e->visibility);
        e->pixel_room = e->visibility ? pixels : 0;
    }
    if (masks && e->mask_room < pixels) {
        free(e->receivers);
        free(e->lit);
        e->receivers = malloc(pixels * sizeof *e->receivers);
        e->lit = malloc(pixels * sizeof *e->lit);
        e->mask_room = e->receivers && e->lit ? pixels : 0;
    }
    if (e->scratch_count < threads) {
        free_scratch(e);
        e->scratch = aligned_alloc(64, (threads * sizeof *e->scratch + 63) / 64 * 64);
        e->scratch_count = e->scratch ? threads : 0;
        for (unsigned i = 0; i < e->scratch_count; i++)
            e->scratch[i].order = NULL, e->scratch[i].order_room = 0;
    }
    return e->pixel_room >= pixels && (!masks || e->mask_room >= pixels) && e->scratch_count;
}

/* Entries of a tile are put in order there. */
static bool reserve_order(struct exact_shadows *e)
{
    for (unsigned i = 0; i < e->scratch_count; i++) {
        struct tile_scratch *s = &e->scratch[i];
        if (s->order_room >= e->bins.most && s->order)
            continue;
        free(s->order);
        s->order = malloc(((size_t)e->bins.most + 1) * sizeof *s->order);
        s->order_room = s->order ? e->bins.most : 0;
        if (!s->order)
            return false;
    }
    return true;
}

/* What was kept of triangles is for another camera or light. */
static void scratch_begin(struct tile_scratch *s, const struct tile_job *job)
{
    for (int i = 0; i < 32; i++) {
        s->x[i] = view_samples32[i][0];
        s->y[i] = view_samples32[i][1];
    }
    for (int i = 0; i < TILE_SIDE; i++)
        s->column[i] = (float)i;
    for (int i = 0; i < OCCLUDERS_KEPT; i++)
        s->occluders[i].id = SCENE_NONE;
    for (int i = 0; i < MASKED_KEPT; i++)
        s->masked[i].id = SCENE_NONE;
    for (int i = 0; i < RECEIVERS_KEPT; i++)
        s->seen[i].id = SCENE_NONE;
    s->slow = (struct slow){.triangles = job->triangles, .view = job->view, .light = job->light, .to_light = job->to_light};
    s->counts = (struct tile_counts){0};
}

static void run(struct exact_shadows *e, struct tile_job *job, struct job_pool *pool, size_t tiles, tile_function *function)
{
    unsigned threads = job_pool_threads(pool);
    for (unsigned i = 0; i < threads; i++)
        scratch_begin(&e->scratch[i], job);
    job_pool_for(pool, tiles, function, job);
    e->counts = (struct tile_counts){0};
    for (unsigned i = 0; i < threads; i++) {
        e->counts.receivers += e->scratch[i].counts.receivers;
        e->counts.tests += e->scratch[i].counts.tests;
        e->counts.undecided += e->scratch[i].counts.undecided;
        e->counts.exact += e->scratch[i].slow.exact;
    }
}

static struct tile_job job_for(struct exact_shadows *e, const struct view *view)
{
    bool directional = e->light.kind == LIGHT_DIRECTIONAL;
    return (struct tile_job){
        .triangles = &e->triangles,
        .grid = &e->grid,
        .light = &e->light,
        .view = view,
        .to_light = {directional, directional ? dvec3_neg(e->light.direction) : e->light.position},
        .screen = screen_make(view),
        .receivers = e->receivers,
        .lit = e->lit,
        .visibility = e->visibility,
        .scratch = e->scratch,
    };
}

static size_t tiles_of(const struct view *view)
{
    return (size_t)((view->width + TILE_SIDE - 1) / TILE_SIDE) * ((view->height + TILE_SIDE - 1) / TILE_SIDE);
}

static const float *out_of_memory(struct error *err)
{
    error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a picture's exact shadows");
    return NULL;
}

const float *exact_shadows_point(struct exact_shadows *e, const struct view *view, const uint32_t *ids, struct job_pool *pool,
                                 struct error *err)
{
    if (!reserve(e, (size_t)view->width * view->height, false, job_pool_threads(pool)))
        return out_of_memory(err);
    struct tile_job job = job_for(e, view);
    job.ids = ids;
    run(e, &job, pool, tiles_of(view), kernel_for(e)->point);
    return e->visibility;
}

const float *exact_shadows_samples32(struct exact_shadows *e, const struct view *view, struct job_pool *pool,
                                     const uint32_t **receivers, const uint32_t **lit, struct error *err)
{
    if (!reserve(e, (size_t)view->width * view->height, true, job_pool_threads(pool)) ||
        !bins_fill(&e->bins, &e->triangles, view, pool) || !reserve_order(e))
        return out_of_memory(err);
    struct tile_job job = job_for(e, view);
    job.bins = &e->bins;
    run(e, &job, pool, tiles_of(view), kernel_for(e)->samples32);
    *receivers = e->receivers;
    *lit = e->lit;
    return e->visibility;
}

struct exact_figures exact_shadows_figures(const struct exact_shadows *e)
{
    double receivers = (double)e->counts.receivers, tests = (double)e->counts.tests;
    return (struct exact_figures){
        .tests_per_receiver = receivers > 0 ? tests / receivers : 0,
        .undecided_fraction = tests > 0 ? (double)e->counts.undecided / (tests * (e->bins.tile_room ? 32 : 1)) : 0,
        .exact = (double)e->counts.exact,
        .grid_side = e->grid.faces[0].side,
        .grid_entries = e->grid.ref_count,
    };
}

size_t exact_shadows_bytes(const struct exact_shadows *e)
{
    return sizeof *e + triangles_bytes(e->triangles.scene) + e->grid.bytes + bins_bytes(&e->bins) +
           e->scratch_count * sizeof *e->scratch + e->pixel_room * sizeof *e->visibility + e->mask_room * 2 * sizeof *e->lit;
}

void exact_shadows_use_plain(struct exact_shadows *e, bool plain) { e->plain = plain; }
