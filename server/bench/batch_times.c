#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/error.h"
#include "batch.h"
#include "interruption.h"
#include "measure.h"
#include "series.h"
#include "stage.h"
#include "turns.h"

static const double TURN_DEG = 0.25;      /* of the lights, each round: --moving of the contract */
static const double BUDGET_MS = 2000;     /* of a cell's timed frames in one regime: slow ones get fewer */
static const double SLOW_FRAME_MS = 3000; /* past that one frame has to do */
enum { ROUNDS_MIN = 3, PASS_ROUNDS_MAX = 5 };

/* One regime of a batch. */
struct regime {
    struct bench_batch *batch;
    int index; /* REGIME_STILL ... */
    unsigned *counts;
    void *pixels;
};

static struct render_settings settings_of(const struct regime *r, const struct bench_cell *cell, unsigned round)
{
    struct render_settings s = r->batch->stage->settings;
    s.system = cell->system;
    s.params = cell->params;
    if (r->index == REGIME_MOVING)
        for (size_t i = 0; i < s.light_count; i++)
            s.lights[i] = light_turned(r->batch->stage->scene, &s.lights[i], TURN_DEG * (round + 1));
    return s;
}

static bool wanted(const struct regime *r, const struct bench_cell *cell)
{
    return !cell->failed[0] && cell->measures & (r->index == REGIME_STILL ? MEASURE_STILL : MEASURE_MOVING);
}

static bool frame(const struct regime *r, struct bench_cell *cell, const struct render_settings *settings,
                  struct frame_info *info)
{
    struct error err = {0};
    if (!stage_frame(r->batch->stage, settings, r->pixels, info, &err)) {
        snprintf(cell->failed, sizeof cell->failed, "%s", err.message);
        return false;
    }
    cell->map_count = info->map_count_total;
    if (info->shadow_bytes > cell->shadow_bytes)
        cell->shadow_bytes = info->shadow_bytes;
    return true;
}

/* Untimed frames: three, fewer where they are slow; of a progressive system under a still light, until it has converged. Returns the last one's
 * milliseconds. */
static double warm_up(const struct regime *r, struct bench_cell *cell)
{
    struct render_settings settings = settings_of(r, cell, 0);
    struct frame_info info = {0};
    bool progressive = r->index == REGIME_STILL && cell->system->converged;
    cell->started = true;
    for (unsigned i = 0; i < (progressive ? STAGE_CONVERGE_MAX : UNTIMED_FRAMES); i++) {
        if (interruption_came(r->batch->interruption) || !frame(r, cell, &settings, &info))
            break;
        if (i + 1 >= UNTIMED_FRAMES ? info.converged : !progressive && info.frame_ms > SLOW_FRAME_MS)
            break;
    }
    return info.frame_ms;
}

static unsigned rounds_for(const struct bench_plan *plan, double frame_ms)
{
    if (frame_ms > SLOW_FRAME_MS)
        return 1;
    double fit = BUDGET_MS / fmax(frame_ms, 0.01);
    unsigned frames = fit < plan->frames ? (unsigned)fit : plan->frames;
    unsigned least = plan->frames < ROUNDS_MIN ? plan->frames : ROUNDS_MIN;
    return frames < least ? least : frames;
}

static unsigned most(const unsigned *counts, size_t n)
{
    unsigned largest = 0;
    for (size_t i = 0; i < n; i++)
        largest = counts[i] > largest ? counts[i] : largest;
    return largest;
}

static void allocate_times(const struct regime *r)
{
    unsigned rounds = most(r->counts, r->batch->count);
    for (size_t i = 0; i < r->batch->count; i++) {
        struct bench_cell *cell = &r->batch->cells[i];
        struct bench_times *t = &cell->times[r->index];
        if (!r->counts[i])
            continue;
        t->frame_ms = malloc(rounds * sizeof *t->frame_ms);
        if (!t->frame_ms) {
            snprintf(cell->failed, sizeof cell->failed, "memory is out for the times of %u frames", rounds);
            continue;
        }
        t->rounds = rounds;
        for (unsigned k = 0; k < rounds; k++)
            t->frame_ms[k] = NAN;
    }
}

/* False: interrupted. */
static bool take_turns(const struct regime *r)
{
    size_t total;
    struct turn *order = turns_order(r->counts, r->batch->count, &total);
    bool good = true;
    allocate_times(r);
    for (size_t i = 0; good && order && i < total; i++) {
        struct bench_cell *cell = &r->batch->cells[order[i].cell];
        struct render_settings settings = settings_of(r, cell, order[i].round);
        struct frame_info info;
        if (interruption_came(r->batch->interruption))
            good = false;
        else if (!cell->failed[0] && frame(r, cell, &settings, &info)) {
            cell->times[r->index].frame_ms[order[i].round] = info.frame_ms;
            cell->times[r->index].measured = true;
        }
    }
    free(order);
    return good;
}

/* Round by round of one pass, for medians. */
struct pass_log {
    double ms[PASS_COUNT][PASS_ROUNDS_MAX];
};

static void clear_passes(struct pass_log *log)
{
    for (int p = 0; p < PASS_COUNT; p++)
        for (int i = 0; i < PASS_ROUNDS_MAX; i++)
            log->ms[p][i] = NAN;
}

static void keep_passes(const struct pass_log *log, unsigned rounds, struct bench_times *out)
{
    for (int p = 0; p < PASS_COUNT; p++)
        out->pass_ms[p] = series_of(log->ms[p], rounds).median;
    out->passes_measured = true;
}

/* The same turns with a finish after each pass: on a software device the only true pass times. */
static bool take_pass_turns(const struct regime *r)
{
    size_t count = r->batch->count, total;
    struct pass_log *logs = calloc(count, sizeof *logs);
    for (size_t i = 0; logs && i < count; i++) {
        clear_passes(&logs[i]);
        r->counts[i] = r->batch->cells[i].measures & MEASURE_PASSES ? (r->counts[i] + 1) / 2 : 0;
        r->counts[i] = r->counts[i] > PASS_ROUNDS_MAX ? PASS_ROUNDS_MAX : r->counts[i];
    }
    struct turn *order = logs ? turns_order(r->counts, count, &total) : NULL;
    bool good = true;
    for (size_t i = 0; good && order && i < total; i++) {
        struct bench_cell *cell = &r->batch->cells[order[i].cell];
        struct render_settings settings = settings_of(r, cell, order[i].round + most(r->counts, count));
        struct frame_info info;
        settings.finish_each_pass = true;
        good = !interruption_came(r->batch->interruption);
        if (!good || cell->failed[0] || !frame(r, cell, &settings, &info))
            continue;
        for (int p = 0; p < PASS_COUNT; p++)
            logs[order[i].cell].ms[p][order[i].round] = info.pass_ms[p];
        if (order[i].round + 1 == most(r->counts, count))
            keep_passes(&logs[order[i].cell], most(r->counts, count), &cell->times[r->index]);
    }
    free(order);
    free(logs);
    return good;
}

static bool time_regime(struct bench_batch *batch, int index)
{
    struct error err = {0};
    struct regime r = {.batch = batch, .index = index, .counts = calloc(batch->count, sizeof *r.counts)};
    r.pixels = stage_picture(&batch->stage->settings, &err);
    bool good = r.counts && r.pixels;
    for (size_t i = 0; good && i < batch->count; i++) {
        struct bench_cell *cell = &batch->cells[i];
        if (!wanted(&r, cell))
            continue;
        double ms = warm_up(&r, cell);
        r.counts[i] = cell->failed[0] ? 0 : rounds_for(batch->plan, ms);
        good = !interruption_came(batch->interruption);
    }
    good = good && take_turns(&r) && take_pass_turns(&r);
    free(r.pixels);
    free(r.counts);
    return good;
}

bool batch_time(struct bench_batch *batch)
{
    for (int i = 0; i < REGIME_COUNT; i++)
        if (!time_regime(batch, i))
            return false;
    return true;
}
