/* The cells of one setup and map size, timed and measured together. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "against.h"
#include "comparison.h"
#include "plan.h"
#include "shots.h"

struct interruption;
struct stage;

/* What is true of one setup: traced for the first cell that asks, kept for the others. Zero-initialised is empty. */
struct bench_truth {
    bool traced;
    struct against against;
    struct comparison comparison;
};
void bench_truths_finish(struct bench_truth truths[BENCH_REFERENCES]);

/* How far the whole run is, in the seconds of bench_plan_seconds(). */
struct bench_pace {
    void (*advance)(void *context, double seconds);
    void *context;
};

struct bench_batch {
    const struct bench_plan *plan;
    struct bench_cell *cells;
    size_t count;
    struct stage *stage;        /* with the setup's settings */
    struct bench_truth *truths; /* BENCH_REFERENCES of them, of this setup */
    struct bench_shots *shots;
    struct interruption *interruption;
    struct bench_pace pace;
};

/* Times, then errors. What fails stays in the cell concerned. False: interrupted. */
bool batch_run(struct bench_batch *batch);

/* Its parts: frames of each regime in turns (times.c) ... */
bool batch_time(struct bench_batch *batch);
/* ... and visibility against the references (errors.c). */
bool batch_compare(struct bench_batch *batch);

void batch_advance(const struct bench_batch *batch, const struct bench_cell *cell, double share);
