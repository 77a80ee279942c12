#include "truth.h"

#include <stdlib.h>
#include <time.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "comparison.h"
#include "stage.h"
#include "stretch.h"
#include "trace/tracer.h"

/* What truth is made with; trees that the kind of truth has no use for are NULL. */
struct truth {
    const struct stage *stage;
    const struct against *against;
    struct view view;
    struct reference *reference;
    struct tracer *tracer;
};

static bool has_lists(const struct comparison *c)
{
    for (size_t i = 0; i < c->light_count; i++)
        if (c->lists[i].given)
            return true;
    return false;
}

static bool truth_init(struct truth *t, const struct stage *stage, const struct against *against, struct comparison *c,
                       struct error *err)
{
    unsigned threads = job_pool_threads(stage->pool);
    *t = (struct truth){
        .stage = stage, .against = against, .view = view_from_camera(&stage->settings.camera, c->width, c->height)};
    if (!(t->reference = reference_create(stage->scene, threads, err)))
        return false;
    bool traces = against->kind != AGAINST_SAMPLES32 || has_lists(c);
    return !traces || (t->tracer = tracer_create(stage->scene, threads, err));
}

static void truth_finish(struct truth *t)
{
    tracer_destroy(t->tracer);
    reference_destroy(t->reference);
}

/* Which pixels lie wholly in one triangle: the camera's traced picture once for each sample, the view shifted so that the sample falls
 * on the pixel's centre. Only a classification of pixels, so the tracer's single precision does. */
static bool find_one_triangle(const struct truth *t, struct comparison *c, struct error *err)
{
    size_t pixels = (size_t)c->width * c->height;
    const struct view *view = &t->view;
    uint32_t *first = malloc(pixels * sizeof *first), *ids = malloc(pixels * sizeof *ids);
    bool good = first && ids;
    if (!good)
        error_set(err, ERROR_TRY_AGAIN, "size", "memory is out for the triangles of %zu pixels", pixels);
    for (int i = 0; good && i < 32; i++) {
        struct view shifted = *view;
        double dx = (view_samples32[i][0] - 0.5) * (view->right_edge - view->left) / view->width;
        double dy = (view_samples32[i][1] - 0.5) * (view->bottom - view->top) / view->height;
        shifted.left += dx, shifted.right_edge += dx;
        shifted.top += dy, shifted.bottom += dy;
        tracer_camera(t->tracer, &shifted, t->stage->pool, i ? ids : first, NULL);
        for (size_t p = 0; p < pixels; p++)
            c->one_triangle[p] = i ? c->one_triangle[p] && ids[p] == first[p] : first[p] != SCENE_NONE;
    }
    free(ids);
    free(first);
    return good;
}

static bool trace_samples32(const struct truth *t, size_t light, const struct reference_progress *progress, struct comparison *c,
                            struct reference_counts *counts)
{
    size_t pixels = (size_t)c->width * c->height;
    uint32_t *receivers = malloc(pixels * sizeof *receivers), *lit = malloc(pixels * sizeof *lit);
    bool good = receivers && lit &&
                reference_samples32(t->reference, &t->view, &t->stage->settings.lights[light], t->stage->pool, progress,
                                    receivers, lit, c->one_triangle, counts);
    for (size_t p = 0; good && p < pixels; p++) {
        int facing = __builtin_popcount(receivers[p]);
        c->receiver[light][p] = facing > 0;
        c->truth[light][p] = facing ? (float)__builtin_popcount(lit[p]) / (float)facing : 0;
    }
    c->truth_masks[light] = (struct sample_masks){receivers, lit};
    return good;
}

/* With a system as the reference, or a light that is a disc, this says only which pixels count. */
static bool trace_point(const struct truth *t, size_t light, const struct reference_progress *progress, struct comparison *c,
                        struct reference_counts *counts)
{
    bool keep = t->against->kind == AGAINST_POINT;
    float *scratch = keep ? NULL : malloc((size_t)c->width * c->height * sizeof *scratch);
    bool good =
        (keep || scratch) && reference_point(t->reference, &t->view, &t->stage->settings.lights[light], c->ids, t->stage->pool,
                                             progress, keep ? c->truth[light] : scratch, c->receiver[light], counts);
    free(scratch);
    return good;
}

static const double POINT_SHARE = 0.05; /* of the time that a disc's rays take */

static bool trace_area(const struct truth *t, size_t light, const struct stretch *whole, struct comparison *c,
                       struct reference_counts *counts)
{
    const struct light *l = &t->stage->settings.lights[light];
    struct stretch first = {whole->progress, whole->from, whole->share * POINT_SHARE},
                   second = {whole->progress, whole->from + first.share, whole->share - first.share};
    const struct reference_progress report = {stretch_report, &first};
    double radius = t->against->radius > 0 ? t->against->radius : tracer_area_radius(t->stage->scene, l);
    if (!trace_point(t, light, &report, c, counts))
        return false;
    for (size_t p = 0; p < (size_t)c->width * c->height; p++)
        counts->rays += c->receiver[light][p] * (uint64_t)t->against->rays;
    return tracer_shadow_area(t->tracer, &t->view, l, radius, t->against->rays, c->ids, c->receiver[light], t->stage->pool,
                              stretch_report, &second, c->truth[light]);
}

static double milliseconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static bool trace_light(const struct truth *t, size_t light, const struct stretch *stretch, struct comparison *c,
                        struct reference_counts *counts)
{
    const struct reference_progress report = {stretch_report, (void *)stretch};
    switch (t->against->kind) {
    case AGAINST_SAMPLES32: return trace_samples32(t, light, &report, c, counts);
    case AGAINST_AREALIGHT: return trace_area(t, light, stretch, c, counts);
    case AGAINST_POINT:
    case AGAINST_SYSTEM: break;
    }
    return trace_point(t, light, &report, c, counts);
}

static bool trace_lights(const struct truth *t, const struct reference_progress *progress, struct comparison *c,
                         struct error *err)
{
    for (size_t i = 0; i < c->light_count; i++) {
        struct reference_counts counts = {0};
        struct stretch stretch = {progress, (double)i / (double)c->light_count, 1.0 / (double)c->light_count};
        if (!trace_light(t, i, &stretch, c, &counts))
            return error_set(err, ERROR_TRY_AGAIN, NULL, "the reference was stopped early, or memory is out for it");
        c->counts.rays += counts.rays;
        c->counts.tests += counts.tests;
        c->counts.exact += counts.exact;
    }
    return true;
}

static bool measure_lists(const struct truth *t, const struct stretch *whole, struct comparison *c, struct error *err)
{
    for (size_t i = 0; i < c->light_count; i++) {
        double share = whole->share / (double)c->light_count;
        struct stretch stretch = {whole->progress, whole->from + share * (double)i, share};
        const struct reference_progress report = {stretch_report, &stretch};
        if (!list_reading_measure(&c->lists[i], t->tracer, t->stage->pool, &report))
            return error_set(err, ERROR_TRY_AGAIN, NULL, "counting the lists was stopped early, or memory is out for it");
    }
    return true;
}

static const double LISTS_SHARE = 0.3; /* of the time, where a system has lists */

bool truth_trace(const struct stage *stage, const struct against *against, const struct reference_progress *progress,
                 struct comparison *c, struct error *err)
{
    struct truth t;
    bool good = truth_init(&t, stage, against, c, err);
    double start = milliseconds(), share = has_lists(c) ? 1 - LISTS_SHARE : 1;
    struct stretch first = {progress, 0, share}, second = {progress, share, 1 - share};
    const struct reference_progress report = {stretch_report, &first};
    good = good && trace_lights(&t, &report, c, err);
    c->reference_ms = milliseconds() - start;
    good = good && measure_lists(&t, &second, c, err) && (against->kind == AGAINST_SAMPLES32 || find_one_triangle(&t, c, err));
    truth_finish(&t);
    return good;
}

bool truth_count_lists(const struct stage *stage, struct comparison *c, struct error *err)
{
    struct truth t = {.stage = stage};
    struct stretch whole = {NULL, 0, 1};
    if (!has_lists(c))
        return true;
    bool good = (t.tracer = tracer_create(stage->scene, job_pool_threads(stage->pool), err)) && measure_lists(&t, &whole, c, err);
    truth_finish(&t);
    return good;
}
