#include "flicker_run.h"

#include <stdlib.h>

#include "against.h"
#include "base/error.h"
#include "base/job_pool.h"
#include "reference/flicker.h"
#include "reference/reference.h"
#include "stage.h"

const char *const flicker_motion_names[] = {[FLICKER_LIGHT] = "light", [FLICKER_CAMERA] = "camera", NULL};

struct flicker_run {
    struct stage *stage;
    const struct against *against;
    const struct reference *reference;
    struct render_settings settings; /* of the next frame */
    struct flicker lights[RENDERER_LIGHTS_MAX];
    void *picture;
    float *tested, *truth;
    uint8_t *receiver;
    uint32_t *ids, *receivers, *lit;
};

static bool run_init(struct flicker_run *run, struct stage *stage, struct error *err)
{
    size_t pixels = (size_t)stage->settings.width * stage->settings.height;
    run->stage = stage;
    run->settings = stage->settings;
    run->settings.aa = 1;
    run->settings.format = PIXELS_RGBA8;
    run->settings.show = SHOW_SHADED;
    run->picture = malloc(pixels * 4);
    run->tested = malloc(pixels * sizeof *run->tested);
    run->truth = malloc(pixels * sizeof *run->truth);
    run->receiver = malloc(pixels);
    run->ids = malloc(pixels * sizeof *run->ids);
    run->receivers = malloc(pixels * sizeof *run->receivers);
    run->lit = malloc(pixels * sizeof *run->lit);
    bool good = run->picture && run->tested && run->truth && run->receiver && run->ids && run->receivers && run->lit;
    for (size_t i = 0; i < run->settings.light_count; i++)
        good = flicker_init(&run->lights[i], pixels) && good;
    return good || error_set(err, ERROR_TRY_AGAIN, "size", "memory is out for the flicker of %zu pixels", pixels);
}

static void run_finish(struct flicker_run *run)
{
    for (size_t i = 0; i < RENDERER_LIGHTS_MAX; i++)
        flicker_finish(&run->lights[i]);
    free(run->picture);
    free(run->tested);
    free(run->truth);
    free(run->receiver);
    free(run->ids);
    free(run->receivers);
    free(run->lit);
}

static void move(struct flicker_run *run, enum flicker_motion motion, unsigned frame)
{
    const struct render_settings *still = &run->stage->settings;
    double degrees = FLICKER_STEP_DEG * frame;
    if (motion == FLICKER_CAMERA)
        run->settings.camera = camera_turned(run->stage->scene, &still->camera, degrees);
    for (size_t i = 0; motion == FLICKER_LIGHT && i < still->light_count; i++)
        run->settings.lights[i] = light_turned(run->stage->scene, &still->lights[i], degrees);
}

static bool trace(struct flicker_run *run, const struct view *view, const struct light *light)
{
    struct job_pool *pool = run->stage->pool;
    if (run->against->kind == AGAINST_POINT)
        return reference_point(run->reference, view, light, run->ids, pool, NULL, run->truth, run->receiver, NULL);
    if (!reference_samples32(run->reference, view, light, pool, NULL, run->receivers, run->lit, NULL, NULL))
        return false;
    for (size_t p = 0; p < (size_t)view->width * view->height; p++) {
        int facing = __builtin_popcount(run->receivers[p]);
        run->receiver[p] = facing > 0;
        run->truth[p] = facing ? (float)__builtin_popcount(run->lit[p]) / (float)facing : 0;
    }
    return true;
}

static bool add_frame(struct flicker_run *run, bool first, struct error *err)
{
    struct renderer *renderer = run->stage->renderer;
    const struct render_settings *settings = &run->settings;
    struct view view = view_from_camera(&settings->camera, settings->width, settings->height);
    struct frame_info info;
    if (!(first ? stage_converge(run->stage, settings, run->picture, &info, NULL, err)
                : stage_frame(run->stage, settings, run->picture, &info, err)))
        return false;
    if (!renderer_read_ids(renderer, run->ids))
        return error_set(err, ERROR_TRY_AGAIN, NULL, "the triangle ids could not be read back from the device");
    for (unsigned i = 0; i < settings->light_count; i++) {
        if (!renderer_read_visibility(renderer, i, run->tested) || !trace(run, &view, &settings->lights[i]))
            return error_set(err, ERROR_TRY_AGAIN, NULL, "light %u's visibility could not be had for flicker", i);
        flicker_add(&run->lights[i], run->tested, run->truth, run->receiver);
    }
    return true;
}

static struct flicker_figures summarise(const struct flicker_run *run, unsigned frames)
{
    struct flicker_figures figures = {.frames = frames};
    for (size_t i = 0; i < run->settings.light_count; i++) {
        figures.count += run->lights[i].count;
        figures.tested += run->lights[i].tested_sum;
        figures.reference += run->lights[i].truth_sum;
    }
    if (figures.count > 0) {
        figures.tested /= (double)figures.count;
        figures.reference /= (double)figures.count;
    }
    figures.difference = figures.tested - figures.reference;
    return figures;
}

static bool run_frames(struct flicker_run *run, enum flicker_motion motion, unsigned frames,
                       const struct reference_progress *progress, struct error *err)
{
    for (unsigned i = 0; i < frames; i++) {
        move(run, motion, i);
        if (!add_frame(run, i == 0, err))
            return false;
        if (progress && !progress->report(progress->context, (i + 1) / (double)frames))
            return error_set(err, ERROR_TRY_AGAIN, NULL, "measuring flicker was stopped early");
    }
    return true;
}

bool flicker_measure(struct stage *stage, const struct against *against, enum flicker_motion motion, unsigned frames,
                     const struct reference *reference, const struct reference_progress *progress, struct flicker_figures *out,
                     struct error *err)
{
    struct flicker_run run = {.against = against, .reference = reference};
    struct reference *made = NULL;
    *out = (struct flicker_figures){0};
    if (against->kind != AGAINST_POINT && against->kind != AGAINST_SAMPLES32)
        return error_set(err, ERROR_USAGE, "flicker", "is measured against point or samples32 only");
    if (!reference)
        run.reference = made = reference_create(stage->scene, job_pool_threads(stage->pool), err);
    bool good = run.reference && run_init(&run, stage, err) && run_frames(&run, motion, frames, progress, err);
    if (good)
        *out = summarise(&run, frames);
    run_finish(&run);
    reference_destroy(made);
    return good;
}
