/* How the tables of this folder are written. */
#pragma once

#include "bench/suite.h"

/* Lists read better with their ends out of sight. */
#define LIST(...)   ((const char *const[]){__VA_ARGS__, NULL})
#define SIZES(...)  ((const double[]){__VA_ARGS__, 0})
#define COUNTS(...) ((const unsigned[]){__VA_ARGS__, 0})

enum { TIMES = MEASURE_STILL | MEASURE_MOVING | MEASURE_PASSES, ERRORS = MEASURE_POINT | MEASURE_SAMPLES32 };

/* Tables and figures that two suites show. */
extern const struct bench_table bench_table_dense, bench_table_models, bench_table_beside, bench_table_bias, bench_table_hard;
extern const struct bench_figure bench_figure_pairs, bench_figure_wings, bench_figure_sizes, bench_figure_recovery;
extern const struct bench_goal bench_goals[];

extern const struct bench_suite bench_suite_smoke, bench_suite_paper, bench_suite_hard, bench_suite_full;
