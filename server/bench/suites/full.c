/* Everything: the paper's tables, the hard cases, every system's parameters, and how cost grows. */
#include "list.h"

static const struct bench_table sweep = {
    .name = "sweep",
    .title = "Time against error",
    .note = "Every system, and of each the parameters that trade time for error.",
    .scenes = LIST("@dense", "@butterfly", "@tree", "@ball"),
    .algorithms = LIST("none", "sm:size=512", "sm:size=1024", "sm:size=2048", "sm:size=4096", "pcf:size=1024", "pcf:size=2048",
                       "pcf:size=4096", "apcf:size=1024", "soft:size=1024", "rgsm:size=1024", "rgsm:size=2048", "spsm:size=1024",
                       "spsm:size=2048", "spsm:size=4096", "coverage:size=512", "coverage:size=1024", "coverage:size=2048",
                       "coverage:size=4096", "coverage:size=1024,nodes=1", "coverage:size=1024,nodes=16", "mask", "asm:budget=4",
                       "asm:budget=16", "asm:budget=64", "exact:samples=1", "exact:samples=32", "reference:samples=1",
                       "reference:samples=1,tracer=embree", "reference:samples=32,tracer=embree"),
    .measures = TIMES | ERRORS,
    .baseline = "sm",
};

#define CURVES "none", "sm", "spsm", "coverage", "exact"

static const struct bench_table by_triangles = {
    .name = "triangles",
    .title = "Time by triangles",
    .note = "One model at several densities.",
    .shape = SHAPE_SCALING,
    .axis = AXIS_TRIANGLES,
    .scenes = LIST("builtin:dragon:triangles=10000", "builtin:dragon:triangles=40000", "builtin:dragon:triangles=160000",
                   "builtin:dragon:triangles=640000", "builtin:dragon:triangles=2500000"),
    .algorithms = LIST(CURVES),
    .measures = TIMES,
    .baseline = "sm",
    .heavy = "it makes models of up to 2.5 million triangles",
};

static const struct bench_table by_map_size = {
    .name = "map_size",
    .title = "Time by map size",
    .note = "A side of 256 to 4096 texels.",
    .shape = SHAPE_SCALING,
    .axis = AXIS_MAP_SIZE,
    .scenes = LIST("builtin:tree"),
    .algorithms = LIST("sm:size=256", "sm:size=512", "sm:size=1024", "sm:size=2048", "sm:size=4096", "spsm:size=256",
                       "spsm:size=512", "spsm:size=1024", "spsm:size=2048", "spsm:size=4096", "coverage:size=256",
                       "coverage:size=512", "coverage:size=1024", "coverage:size=2048", "coverage:size=4096"),
    .measures = TIMES | MEASURE_POINT,
    .baseline = "sm",
};

static const struct bench_table by_pixels = {
    .name = "pixels",
    .title = "Time by pixels",
    .note = "Half of the picture's width to one and a half times it.",
    .shape = SHAPE_SCALING,
    .axis = AXIS_PIXELS,
    .scenes = LIST("builtin:tree"),
    .algorithms = LIST(CURVES),
    .measures = TIMES,
    .sizes = SIZES(0.5, 1, 1.5),
    .baseline = "sm",
};

static const struct bench_table by_lights = {
    .name = "lights",
    .title = "Time by lights",
    .note = "The scene's light, turned evenly about its vertical axis into so many.",
    .shape = SHAPE_SCALING,
    .axis = AXIS_LIGHTS,
    .scenes = LIST("builtin:tree"),
    .algorithms = LIST(CURVES),
    .measures = TIMES,
    .size = 0.5,
    .lights = COUNTS(1, 2, 4, 8),
    .baseline = "sm",
};

const struct bench_suite bench_suite_full = {
    .name = "full",
    .summary = "all of it: time against error, hard cases, scaling, memory",
    .tables = (const struct bench_table *const[]){&sweep, &bench_table_dense, &bench_table_models, &bench_table_beside,
                                                  &bench_table_bias, &bench_table_hard, &by_triangles, &by_map_size, &by_pixels,
                                                  &by_lights, NULL},
    .figures = (const struct bench_figure *const[]){&bench_figure_wings, &bench_figure_pairs, &bench_figure_sizes,
                                                    &bench_figure_recovery, NULL},
    .goals = bench_goals,
    .frames = 5,
    .width = 1280,
    .height = 720,
};
