#include "bench/suite.h"

#include <string.h>

/* Lists read better with their terminator out of sight. */
#define LIST(...)   ((const char *const[]){__VA_ARGS__, NULL})
#define SIZES(...)  ((const double[]){__VA_ARGS__, 0})
#define COUNTS(...) ((const unsigned[]){__VA_ARGS__, 0})

enum { TIMES = MEASURE_STILL | MEASURE_MOVING | MEASURE_PASSES, ERRORS = MEASURE_POINT | MEASURE_SAMPLES32 };

static const struct bench_table smoke_table = {
    .name = "smoke",
    .title = "Every system once",
    .note = "Small pictures of built-in scenes: whether everything runs, not how fast.",
    .scenes = LIST("builtin:box", "builtin:dragon:triangles=20000", "builtin:hard-04-contact"),
    .algorithms = LIST("*"),
    .measures = TIMES | ERRORS,
    .baseline = "sm",
};

static const struct bench_suite smoke = {
    .name = "smoke",
    .summary = "every system once on small built-in scenes: seconds",
    .tables = (const struct bench_table *const[]){&smoke_table, NULL},
    .frames = 3,
    .width = 160,
    .height = 90,
};

const struct bench_suite *const bench_suites[] = {&smoke, NULL};

const struct bench_suite *bench_suite_find(const char *name)
{
    for (size_t i = 0; bench_suites[i]; i++)
        if (!strcmp(bench_suites[i]->name, name))
            return bench_suites[i];
    return NULL;
}
