/* The cells of one setup and map size, timed and measured together. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "plan.h"

struct interruption;
struct stage;

/* How far the whole run is, in the seconds of bench_plan_seconds(). */
struct bench_pace {
    void (*advance)(void *context, double seconds);
    void *context;
};

struct bench_batch {
    const struct bench_plan *plan;
    struct bench_cell *cells;
    size_t count;
    struct stage *stage; /* with the setup's settings */
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
