#include "list.h"

static const struct bench_table every_system = {
    .name = "smoke",
    .title = "Every system once",
    .note = "Small pictures of built-in scenes: whether everything runs, not how fast.",
    .scenes = LIST("builtin:box", "builtin:dragon:triangles=20000", "builtin:hard-04-contact"),
    .algorithms = LIST("*"),
    .measures = TIMES | ERRORS,
    .baseline = "sm",
};

const struct bench_suite bench_suite_smoke = {
    .name = "smoke",
    .summary = "every system once on small built-in scenes: seconds",
    .tables = (const struct bench_table *const[]){&every_system, NULL},
    .frames = 3,
    .width = 160,
    .height = 90,
};
