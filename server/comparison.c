#include "comparison.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "stage.h"
#include "reference/oracle.h"
#include "trace/tracer.h"

void comparison_finish(struct comparison *c)
{
    for (size_t i = 0; i < RENDERER_LIGHTS_MAX; i++) {
        free(c->tested[i]);
        free(c->truth[i]);
        free(c->receiver[i]);
        free(c->masks[i].receivers);
        free(c->masks[i].lit);
        list_reading_finish(&c->lists[i]);
        free(c->truth_masks[i].receivers);
        free(c->truth_masks[i].lit);
    }
    free(c->ids);
    free(c->one_triangle);
    free(c->picture);
    *c = (struct comparison){0};
}

static bool comparison_init(struct comparison *c, const struct render_settings *settings, struct error *err)
{
    *c = (struct comparison){.width = settings->width, .height = settings->height, .light_count = settings->light_count};
    size_t pixels = (size_t)c->width * c->height;
    c->ids = calloc(pixels, sizeof *c->ids);
    c->one_triangle = calloc(pixels, 1);
    c->picture = calloc(pixels, 4);
    bool good = c->ids && c->one_triangle && c->picture;
    for (size_t i = 0; i < c->light_count; i++) {
        c->wrong_samples[i] = -1;
        c->tested[i] = calloc(pixels, sizeof(float));
        c->truth[i] = calloc(pixels, sizeof(float));
        c->receiver[i] = calloc(pixels, 1);
        good = good && c->tested[i] && c->truth[i] && c->receiver[i];
    }
    if (good)
        return true;
    return error_set(err, ERROR_TRY_AGAIN, "size",
                     "memory is out for the visibility of %zu lights at %ux%u; a smaller --size is accepted", c->light_count,
                     c->width, c->height);
}

/* A stretch of the whole bar. */
struct stretch {
    const struct reference_progress *progress;
    double from, share;
};

static bool report_stretch(void *context, double done)
{
    const struct stretch *s = context;
    return !s->progress || s->progress->report(s->progress->context, s->from + s->share * done);
}

static bool read_visibility(struct stage *stage, const struct render_settings *settings, float *const *out, struct error *err)
{
    for (size_t i = 0; i < settings->light_count; i++)
        if (!renderer_read_visibility(stage->renderer, (unsigned)i, out[i]))
            return error_set(err, ERROR_TRY_AGAIN, NULL, "light %zu's visibility could not be read back from the device", i);
    return true;
}

/* Masks are a second copy of the picture and more: they are read only where truth has some to hold against them. */
static bool read_masks(struct stage *stage, unsigned light, struct comparison *c, struct error *err)
{
    struct sample_masks *m = &c->masks[light];
    size_t pixels = (size_t)c->width * c->height;
    if (!stage->settings.system->read_masks)
        return true;
    m->receivers = malloc(pixels * sizeof *m->receivers);
    m->lit = malloc(pixels * sizeof *m->lit);
    if (!m->receivers || !m->lit)
        return error_set(err, ERROR_TRY_AGAIN, "size", "memory is out for the masks of %zu pixels", pixels);
    if (renderer_read_masks(stage->uploaded, light, m->receivers, m->lit, err))
        return true;
    free(m->receivers);
    free(m->lit);
    *m = (struct sample_masks){0};
    return err->code == ERROR_NONE;
}

static bool read_what_it_tells(struct stage *stage, const struct against *against, struct comparison *c, struct error *err)
{
    for (unsigned i = 0; i < c->light_count; i++) {
        c->figure_count[i] = renderer_read_figures(stage->uploaded, i, c->figures[i]);
        if (against->kind == AGAINST_SAMPLES32 && !read_masks(stage, i, c, err))
            return false;
        if (!c->without_lists && !list_reading_take(stage, i, &c->lists[i], err))
            return false;
    }
    return true;
}

static bool render_tested(struct stage *stage, const struct against *against, struct comparison *c, struct error *err)
{
    struct render_settings settings = stage->settings;
    struct frame_info info;
    settings.aa = 1;
    settings.format = PIXELS_RGBA8;
    settings.show = SHOW_SHADED;
    if (!stage_converge(stage, &settings, c->picture, &info, &c->converge_frames, err) ||
        !read_visibility(stage, &settings, c->tested, err) || !read_what_it_tells(stage, against, c, err))
        return false;
    c->converged = info.converged;
    c->frame_ms = info.frame_ms;
    if (!renderer_read_ids(stage->renderer, c->ids))
        return error_set(err, ERROR_TRY_AGAIN, NULL, "the triangle ids could not be read back from the device");
    return true;
}

/* The other system sees the same ids: the camera pass does not depend on the system. */
static bool render_truth(struct stage *stage, const struct against *against, struct comparison *c, struct error *err)
{
    struct render_settings settings = stage->settings;
    struct frame_info info;
    settings.aa = 1;
    settings.format = PIXELS_RGBA8;
    settings.system = against->system;
    settings.params = against->params;
    void *pixels = stage_picture(&settings, err);
    bool good =
        pixels && stage_converge(stage, &settings, pixels, &info, NULL, err) && read_visibility(stage, &settings, c->truth, err);
    free(pixels);
    return good;
}

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
    const struct reference_progress report = {report_stretch, &first};
    double radius = t->against->radius > 0 ? t->against->radius : tracer_area_radius(t->stage->scene, l);
    if (!trace_point(t, light, &report, c, counts))
        return false;
    for (size_t p = 0; p < (size_t)c->width * c->height; p++)
        counts->rays += c->receiver[light][p] * (uint64_t)t->against->rays;
    return tracer_shadow_area(t->tracer, &t->view, l, radius, t->against->rays, c->ids, c->receiver[light], t->stage->pool,
                              report_stretch, &second, c->truth[light]);
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
    const struct reference_progress report = {report_stretch, (void *)stretch};
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
        const struct reference_progress report = {report_stretch, &stretch};
        if (!list_reading_measure(&c->lists[i], t->tracer, t->stage->pool, &report))
            return error_set(err, ERROR_TRY_AGAIN, NULL, "counting the lists was stopped early, or memory is out for it");
    }
    return true;
}

static const double LISTS_SHARE = 0.3; /* of the time, where a system has lists */

static bool compute_truth(const struct stage *stage, const struct against *against, const struct reference_progress *progress,
                          struct comparison *c, struct error *err)
{
    struct truth t;
    bool good = truth_init(&t, stage, against, c, err);
    double start = milliseconds(), share = has_lists(c) ? 1 - LISTS_SHARE : 1;
    struct stretch first = {progress, 0, share}, second = {progress, share, 1 - share};
    const struct reference_progress report = {report_stretch, &first};
    good = good && trace_lights(&t, &report, c, err);
    c->reference_ms = milliseconds() - start;
    good = good && measure_lists(&t, &second, c, err) && (against->kind == AGAINST_SAMPLES32 || find_one_triangle(&t, c, err));
    truth_finish(&t);
    return good;
}

static bool measure(struct comparison *c, struct error *err)
{
    struct metrics_pool pool;
    bool good = true;
    metrics_pool_init(&pool);
    for (size_t i = 0; good && i < c->light_count; i++) {
        if (c->masks[i].receivers && c->truth_masks[i].receivers)
            c->wrong_samples[i] = metrics_wrong_samples(&c->masks[i], &c->truth_masks[i], (size_t)c->width * c->height);
        const struct metrics_input input = {
            .width = c->width,
            .height = c->height,
            .visibility = c->tested[i],
            .reference = c->truth[i],
            .receiver = c->receiver[i],
            .one_triangle = c->one_triangle,
            .wrong_samples = c->wrong_samples[i],
        };
        good = metrics_pool_add(&pool, &input, &c->light[i]);
    }
    metrics_pool_finish(&pool);
    c->total = pool.total;
    return good || error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for the error figures");
}

bool comparison_render(struct stage *stage, const struct against *against, struct comparison *out, struct error *err)
{
    return comparison_init(out, &stage->settings, err) && render_tested(stage, against, out, err) &&
           (against->kind != AGAINST_SYSTEM || render_truth(stage, against, out, err));
}

bool comparison_trace(const struct stage *stage, const struct against *against, const struct reference_progress *progress,
                      struct comparison *c, struct error *err)
{
    return compute_truth(stage, against, progress, c, err) && measure(c, err);
}

/* One light's share: what such lists would have made of it, in place of what was tested. */
static bool add_oracle(const struct truth *t, const struct comparison *c, size_t light, unsigned length,
                       const struct reference_progress *progress, float *visibility, struct metrics_pool *pool)
{
    struct metrics m;
    const struct list_reading *lists = &c->lists[light];
    const struct oracle_input in = {.maps = lists->fit.maps,
                                    .map_count = lists->fit.map_count,
                                    .casters = lists->fit.casters,
                                    .caster_count = lists->fit.caster_count,
                                    .length = length,
                                    .view = &t->view,
                                    .light = &t->stage->settings.lights[light],
                                    .ids = c->ids,
                                    .receiver = c->receiver[light]};
    const struct metrics_input measured = {.width = c->width,
                                           .height = c->height,
                                           .visibility = visibility,
                                           .reference = c->truth[light],
                                           .receiver = c->receiver[light],
                                           .one_triangle = c->one_triangle,
                                           .wrong_samples = -1};
    return oracle_visibility(t->stage->scene, t->tracer, &in, t->stage->pool, progress, visibility) &&
           metrics_pool_add(pool, &measured, &m);
}

bool comparison_oracle(const struct stage *stage, const struct against *against, unsigned length,
                       const struct reference_progress *progress, const struct comparison *c, struct metrics *out,
                       struct error *err)
{
    struct metrics_pool pool;
    struct truth t = {.stage = stage, .against = against, .view = view_from_camera(&stage->settings.camera, c->width, c->height)};
    float *visibility = malloc((size_t)c->width * c->height * sizeof *visibility);
    if (visibility)
        t.tracer = tracer_create(stage->scene, job_pool_threads(stage->pool), err);
    bool good = t.tracer != NULL;
    metrics_pool_init(&pool);
    for (size_t i = 0; good && i < c->light_count; i++) {
        struct stretch stretch = {progress, (double)i / (double)c->light_count, 1.0 / (double)c->light_count};
        const struct reference_progress report = {report_stretch, &stretch};
        good = !c->lists[i].given || add_oracle(&t, c, i, length, &report, visibility, &pool);
    }
    *out = pool.total;
    metrics_pool_finish(&pool);
    truth_finish(&t);
    free(visibility);
    return good || error_set(err, ERROR_TRY_AGAIN, NULL, "the oracle was stopped early, or memory is out for it");
}

static void forget_tested(struct comparison *c)
{
    for (size_t i = 0; i < c->light_count; i++) {
        free(c->masks[i].receivers);
        free(c->masks[i].lit);
        c->masks[i] = (struct sample_masks){0};
        c->wrong_samples[i] = -1;
        list_reading_finish(&c->lists[i]);
        c->lists[i] = (struct list_reading){0};
    }
}

static bool repeat_lists(const struct stage *stage, struct comparison *c, struct error *err)
{
    struct truth t = {.stage = stage};
    struct stretch whole = {NULL, 0, 1};
    if (!has_lists(c))
        return true;
    bool good = (t.tracer = tracer_create(stage->scene, job_pool_threads(stage->pool), err)) && measure_lists(&t, &whole, c, err);
    truth_finish(&t);
    return good;
}

bool comparison_repeat(struct stage *stage, const struct against *against, struct comparison *c, struct error *err)
{
    forget_tested(c);
    /* They do not depend on the reference. */
    c->without_lists = against->kind != AGAINST_POINT;
    return render_tested(stage, against, c, err) && repeat_lists(stage, c, err) && measure(c, err);
}
