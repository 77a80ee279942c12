#include "measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "progress.h"
#include "stage.h"

static const double TURN_DEG = 0.25; /* of the lights for each timed frame */
static const double PASS_SUM_TOLERANCE = 0.1;
enum { PASS_FRAMES_MAX = 20 }; /* of the second run: medians settle long before */
enum { PASS_RUNS_MAX = 3 };

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double quantile(double *values, size_t count, double p)
{
    qsort(values, count, sizeof *values, compare_doubles);
    if (p == 0.5 && count % 2 == 0)
        return 0.5 * (values[count / 2 - 1] + values[count / 2]);
    size_t rank = (size_t)ceil(p * (double)count);
    return values[rank > 0 ? rank - 1 : 0];
}

/* A run of frames: untimed ones, then timed ones whose times it keeps. */
struct run {
    struct stage *stage;
    struct render_settings settings;
    bool moving;
    unsigned untimed, frames;
    double *times;            /* frames */
    double *pass[PASS_COUNT]; /* frames each */
    void *pixels;
    const struct frame_sink *sink; /* NULL: nobody looks */
    struct progress *progress;
    double progress_from, progress_share;
};

static bool run_start(struct run *run, struct stage *stage, unsigned frames, bool moving, struct error *err)
{
    *run =
        (struct run){.stage = stage, .settings = stage->settings, .moving = moving, .untimed = UNTIMED_FRAMES, .frames = frames};
    run->pixels = stage_picture(&run->settings, err);
    double *times = calloc((size_t)frames * (PASS_COUNT + 1), sizeof *times);
    if (!times)
        error_set(err, ERROR_TRY_AGAIN, "frames-timed", "memory is out for the times of %u frames", frames);
    run->times = times;
    for (int p = 0; times && p < PASS_COUNT; p++)
        run->pass[p] = times + (size_t)frames * (size_t)(p + 1);
    return run->pixels && times;
}

static void run_finish(struct run *run)
{
    free(run->times);
    free(run->pixels);
}

static void turn_lights(struct run *run, unsigned timed_frame)
{
    const struct render_settings *still = &run->stage->settings;
    for (size_t i = 0; i < still->light_count; i++)
        run->settings.lights[i] = light_turned(run->stage->scene, &still->lights[i], TURN_DEG * timed_frame);
}

static void keep_times(struct run *run, unsigned n, const struct frame_info *frame)
{
    run->times[n] = frame->frame_ms;
    for (int p = 0; p < PASS_COUNT; p++)
        run->pass[p][n] = frame->pass_ms[p];
}

static bool run_frames(struct run *run, struct measurement *out, struct error *err)
{
    unsigned total = run->untimed + run->frames;
    for (unsigned i = 0; i < total; i++) {
        bool timed = i >= run->untimed;
        if (run->moving && timed)
            turn_lights(run, i - run->untimed + 1);
        if (!stage_frame(run->stage, &run->settings, run->pixels, &out->last, err))
            return false;
        if (timed)
            keep_times(run, i - run->untimed, &out->last);
        if (run->sink && !run->sink->take(run->sink->context, i, &out->last, run->pixels, err))
            return false;
        out->shadow_bytes = out->last.shadow_bytes;
        if (out->shadow_bytes > out->shadow_bytes_max)
            out->shadow_bytes_max = out->shadow_bytes;
        if (run->progress)
            progress_set(run->progress, run->progress_from + run->progress_share * (i + 1) / (double)total);
    }
    return true;
}

static void pass_medians(struct run *run, struct measurement *out)
{
    for (int p = 0; p < PASS_COUNT; p++)
        out->pass_ms[p] = quantile(run->pass[p], run->frames, 0.5);
}

/* How far the passes are from adding up to the frame, as a fraction of it. */
static double passes_gap(const double *pass_ms, double frame_ms)
{
    double sum = 0;
    for (int p = 0; p < PASS_COUNT; p++)
        sum += pass_ms[p];
    return fabs(sum - frame_ms) / frame_ms;
}

static bool measure_passes(struct stage *stage, const struct measurement *first, struct progress *progress,
                           struct measurement *out, struct error *err)
{
    struct run run;
    unsigned frames = first->frames < PASS_FRAMES_MAX ? first->frames : PASS_FRAMES_MAX;
    bool good = run_start(&run, stage, frames, first->moving, err);
    run.settings.finish_each_pass = true;
    run.untimed = 1;
    run.progress = progress;
    run.progress_from = run.progress_share = 0.5;
    good = good && run_frames(&run, out, err);
    if (good)
        pass_medians(&run, out);
    run_finish(&run);
    return good;
}

/* Twenty of a second each would be long to wait for. */
static const double DEFAULT_RUN_MS = 10000;

unsigned measure_default_frames(double frame_ms)
{
    double fit = DEFAULT_RUN_MS / (frame_ms > 0 ? frame_ms : 1);
    return fit >= FRAMES_TIMED_DEFAULT ? FRAMES_TIMED_DEFAULT : fit < UNTIMED_FRAMES ? UNTIMED_FRAMES : (unsigned)fit;
}

static bool run_timed(struct run *run, struct measurement *out, struct error *err)
{
    if (!run_frames(run, out, err))
        return false;
    pass_medians(run, out);
    out->min_ms = quantile(run->times, run->frames, 0);
    out->median_ms = quantile(run->times, run->frames, 0.5);
    out->p95_ms = quantile(run->times, run->frames, 0.95);
    return true;
}

static bool measure_times(struct stage *stage, struct progress *progress, struct measurement *out, struct error *err)
{
    struct run run;
    bool progressive = stage->settings.system->converged && !out->moving;
    bool good = run_start(&run, stage, out->frames, out->moving, err);
    run.progress = progress;
    run.progress_share = 0.5;
    good = good && (!progressive || stage_converge(stage, &run.settings, run.pixels, &out->last, &out->converge_frames, err)) &&
           run_timed(&run, out, err);
    run_finish(&run);
    return good;
}

bool measure_progress(struct stage *stage, unsigned frames, const struct frame_sink *sink, struct progress *progress,
                      struct measurement *out, struct error *err)
{
    struct run run;
    *out = (struct measurement){.frames = frames};
    bool good = run_start(&run, stage, frames, false, err);
    run.untimed = 0;
    run.settings.finish_each_pass = true;
    run.sink = sink;
    run.progress = progress;
    run.progress_share = 1;
    good = good && run_timed(&run, out, err);
    run_finish(&run);
    return good;
}

/* On a busy machine the second run may find other conditions than the first: then it is run again, and the run that comes closest to the
 * first one's frame time is kept. */
bool measure_frames(struct stage *stage, unsigned frames, bool moving, struct progress *progress, struct measurement *out,
                    struct error *err)
{
    *out = (struct measurement){.frames = frames, .moving = moving};
    if (!measure_times(stage, progress, out, err))
        return false;
    double gap = renderer_device(stage->renderer)->software ? INFINITY : passes_gap(out->pass_ms, out->median_ms);
    for (int i = 0; i < PASS_RUNS_MAX && gap > PASS_SUM_TOLERANCE; i++) {
        struct measurement finished = {0};
        if (!measure_passes(stage, out, progress, &finished, err))
            return false;
        if (passes_gap(finished.pass_ms, out->median_ms) >= gap)
            continue;
        gap = passes_gap(finished.pass_ms, out->median_ms);
        memcpy(out->pass_ms, finished.pass_ms, sizeof out->pass_ms);
    }
    return true;
}
