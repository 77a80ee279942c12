#include "list.h"

const struct bench_table bench_table_hard = {
    .name = "hard",
    .title = "Hard cases",
    .note =
        "Small scenes that each try one weakness. Systems that answer with a fraction, or decide 32 samples, are held against samples32 too.",
    .shape = SHAPE_MATRIX,
    .scenes = LIST("builtin:hard-*"),
    .algorithms = LIST("*", "exact:samples=32", "coverage:nodes=16"),
    .measures = ERRORS,
    .size = 0.25,
};

const struct bench_suite bench_suite_hard = {
    .name = "hard",
    .summary = "every system on every hard case: errors only",
    .tables = (const struct bench_table *const[]){&bench_table_hard, NULL},
    .frames = 1,
    .width = 1280,
    .height = 720,
};
