/* A suite made concrete: which cells are run on which scene, and later what came of them. The run fills the plan in; the writers read
 * nothing else. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/array.h"
#include "reference/identified.h"
#include "reference/metrics.h"
#include "renderer.h"
#include "suite.h"

struct error;

/* What the command line says. Strings are borrowed. */
struct bench_options {
    const struct bench_suite *suite;
    const char *models; /* folder; NULL: built-in scenes only */
    const char *filter; /* keeps what has it in its scene or algorithm; several, separated by commas, must all match; NULL: all */
    const char *tables; /* names, separated by commas: the other tables, and the figures, are left out; NULL: all */
    unsigned frames;    /* 0: the suite's */
    uint32_t width, height; /* 0: the suite's */
    bool quick;
    bool pictures;         /* the suite's figures too */
    bool builtin_pictures; /* of built-in scenes, whatever `models` holds: for what is published */
};

enum { REGIME_STILL, REGIME_MOVING, REGIME_COUNT };
enum { AGAINST_POINT_INDEX, AGAINST_SAMPLES32_INDEX, AGAINST_AREALIGHT_INDEX, BENCH_REFERENCES };

extern const char *const bench_regime_names[REGIME_COUNT];
extern const char *const bench_reference_names[BENCH_REFERENCES];

/* What is rendered, but for the shadow system. */
struct bench_setup {
    char scene[400]; /* as scene_load() takes it */
    uint32_t width, height;
    unsigned lights; /* 0: the scene's own */

    /* Filled in by the run. */
    size_t triangles, drawn_triangles;
    char failed[480]; /* why it could not be set up, else "" */
};

struct bench_times {
    bool measured;
    unsigned rounds;  /* entries of frame_ms */
    double *frame_ms; /* owned; the round's frame, NAN where this cell sat it out */
    double pass_ms[PASS_COUNT];
    bool passes_measured;
};

struct bench_errors {
    bool measured;
    struct metrics m;
};

/* One algorithm in one setup: what the tables show. */
struct bench_cell {
    size_t setup;
    uint32_t tables;  /* bit i: the suite's table i shows it */
    uint32_t figures; /* likewise */
    char name[160];   /* as the suite writes it */
    const struct shadow_system *system;
    struct shadow_params params;
    unsigned map_size; /* 0: the system has no such parameter; cells of one size are timed together */
    unsigned measures; /* enum bench_measure */

    /* Filled in by the run. */
    bool started;
    char failed[480]; /* why there is nothing or not all, else "" */
    struct bench_times times[REGIME_COUNT];
    struct bench_errors errors[BENCH_REFERENCES];
    size_t shadow_bytes, map_count;
    bool has_lists;
    struct identified lists; /* of all lights */
};

struct bench_plan {
    const struct bench_suite *suite;
    uint32_t width, height;
    unsigned frames;
    ARRAY(struct bench_setup) setups; /* those of one scene follow one another */
    ARRAY(struct bench_cell) cells;   /* by setup, then by map size, then as the suite has them */
    ARRAY(char *) left_out;           /* sentences: which systems are not there, what --quick dropped */
};

/* The caller finishes it whatever this returns. ERROR_USAGE when the filter leaves nothing; ERROR_TRY_AGAIN. */
bool bench_plan_init(struct bench_plan *plan, const struct bench_options *options, struct error *err);
void bench_plan_finish(struct bench_plan *plan);

/* A guess, before anything has run: seconds on two cores. */
double bench_plan_seconds(const struct bench_plan *plan);
double bench_cell_seconds(const struct bench_plan *plan, const struct bench_cell *cell);

/* First cell after `first` that is not timed together with it. */
size_t bench_batch_end(const struct bench_plan *plan, size_t first);

/* The baseline of the first table that shows the cell and has one; NULL: none. */
const char *bench_cell_baseline_name(const struct bench_plan *plan, const struct bench_cell *cell);

/* The cell of `system`, its parameters at their defaults but for the map size, in the same setup and of the same map size. NULL: none, or it is
 * the cell itself. */
const struct bench_cell *bench_baseline(const struct bench_plan *plan, const struct bench_cell *cell, const char *system);

/* The mean share of a texel's seen triangles that its list holds; NAN: no lists. */
double bench_identified_fraction(const struct bench_cell *cell);

/* The least misclassified against point over the cells of `system` in the same setup and map size; -1: not measured. */
int64_t bench_best_misclassified(const struct bench_plan *plan, const struct bench_cell *cell, const char *system);
