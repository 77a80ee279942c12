/* Tables 1 and 2 and figures 9, 11 and 12 of Li et al. 2017 (the sub-pixel coverage paper), with the errors beside the times. */
#include "list.h"

#define FOUR_MODELS LIST("@dense", "@butterfly", "@tree", "@ball")

const struct bench_table bench_table_dense = {
    .name = "table1",
    .title = "Dense model, by map size",
    .note =
        "The paper's table 1: what the coverage lists cost over a plain depth map, and what they get right. Published there (GTX 580): +52, +30, "
        "+28 and +16 % at 512, 1024, 2048 and 4096.",
    .scenes = LIST("@dense"),
    .algorithms = LIST("sm:size=512", "coverage:size=512", "sm:size=1024", "coverage:size=1024", "sm:size=2048",
                       "coverage:size=2048", "sm:size=4096", "coverage:size=4096"),
    .measures = TIMES | ERRORS,
    .baseline = "sm",
};

const struct bench_table bench_table_models = {
    .name = "table2",
    .title = "Four kinds of model",
    .note =
        "The paper's table 2, with the share of misclassified pixels in each row. Published there at 1024 (GTX 580, sm / spsm / coverage, ms): dragon "
        "32.8 / 42.5 / 42.8, butterfly 15.7 / 24.6 / 25.4, tree 11.1 / 16.9 / 17.2, ball 7.6 / 10.7 / 10.9.",
    .scenes = FOUR_MODELS,
    .algorithms = LIST("sm:size=1024", "rgsm:size=1024", "spsm:size=1024", "coverage:size=1024", "sm:size=2048", "rgsm:size=2048",
                       "spsm:size=2048", "coverage:size=2048"),
    .measures = TIMES | ERRORS,
    .baseline = "sm",
};

const struct bench_table bench_table_beside = {
    .name = "beside",
    .title = "The other systems on the same models",
    .note =
        "Systems that filter or decide 32 samples a pixel are to be judged by their columns against samples32; soft ones also against an area light.",
    .scenes = FOUR_MODELS,
    .algorithms = LIST("none", "sm:size=1024", "pcf:size=1024", "apcf:size=1024", "soft:size=1024", "mask", "asm",
                       "coverage:size=1024,nodes=16", "coverage:size=1024,recovery=off", "coverage:size=1024,layout=packed",
                       "exact:samples=1", "exact:samples=32", "reference:samples=1", "reference:samples=1,tracer=embree",
                       "reference:samples=32,tracer=embree"),
    .measures = TIMES | ERRORS | MEASURE_AREALIGHT,
    .baseline = "sm",
};

const struct bench_table bench_table_bias = {
    .name = "bias",
    .title = "Bias sweep of the plain depth map",
    .note = "What the others are compared with: the plain depth map at its best slope.",
    .scenes = FOUR_MODELS,
    .algorithms = LIST("sm:size=1024,slope=0.5", "sm:size=1024,slope=1", "sm:size=1024,slope=2", "sm:size=2048,slope=0.5",
                       "sm:size=2048,slope=1", "sm:size=2048,slope=2", "sm:size=4096,slope=0.5", "sm:size=4096,slope=1",
                       "sm:size=4096,slope=2"),
    .measures = MEASURE_POINT,
};

/* The crop falls where the first is most wrong. */
const struct bench_figure bench_figure_wings = {
    .name = "fig9",
    .title = "Thin wings and legs",
    .note = "The paper's figure 9. Left: the picture; right: where it is wrong (orange too bright, blue too dark).",
    .kind = FIGURE_PICTURES,
    .scene = "@butterfly",
    .algorithms = LIST("sm:size=1024", "spsm:size=1024", "coverage:size=1024"),
};

const struct bench_figure bench_figure_pairs = {
    .name = "fig11",
    .title = "Differences between each two",
    .note = "The paper's figure 11: orange where the first is brighter, blue where it is darker.",
    .kind = FIGURE_PAIRS,
    .scene = "@ball",
    .algorithms = LIST("sm:size=1024", "spsm:size=1024", "coverage:size=1024"),
};

const struct bench_figure bench_figure_sizes = {
    .name = "fig12",
    .title = "By map size",
    .note = "The paper's figure 12.",
    .kind = FIGURE_PICTURES,
    .scene = "@tree",
    .algorithms = LIST("coverage:size=512", "coverage:size=1024", "coverage:size=2048"),
};

const struct bench_figure bench_figure_recovery = {
    .name = "recovery",
    .title = "Boundary recovery off and on",
    .note = "Wires thinner than a texel, which no texel's own triangle holds.",
    .kind = FIGURE_PICTURES,
    .scene = "@ball",
    .algorithms = LIST("coverage:size=512,recovery=off", "coverage:size=512"),
};

/* Goals of the project for these models. */
const struct bench_goal bench_goals[] = {
    {GOAL_ERROR_RATIO, "@ball", "coverage:size=1024", "sm", 0.2},
    {GOAL_ERROR_RATIO, "@butterfly", "coverage:size=1024", "sm", 0.2},
    {GOAL_ERROR_RATIO, "@tree", "coverage:size=1024", "sm", 0.2},
    {GOAL_ERROR_RATIO, "@dense", "coverage:size=1024", "sm", 0.6},
    {GOAL_ERROR_RATIO, "@dense", "coverage:size=1024,nodes=16", "sm", 0.2},
    {GOAL_ERROR_RATIO, "@dense", "coverage:size=4096", "sm", 0.2},
    {GOAL_MOVING_RATIO, "@dense", "coverage:size=1024", "sm:size=1024", 1.3},
    {GOAL_MOVING_RATIO, "@dense", "coverage:size=4096", "sm:size=4096", 1.3},
    {GOAL_STILL_RATIO, "@dense", "coverage:size=1024", "sm:size=1024", 1.1},
    {GOAL_MOVING_RATIO, "@dense", "coverage:size=1024", "spsm:size=1024", 1.05},
    {GOAL_MOVING_RATIO, "@butterfly", "coverage:size=1024", "sm:size=1024", 1.3},
    {GOAL_MOVING_RATIO, "@tree", "coverage:size=1024", "sm:size=1024", 1.3},
    {GOAL_MOVING_RATIO, "@ball", "coverage:size=1024", "sm:size=1024", 1.3},
    {GOAL_STILL_RATIO, "@dense", "apcf:size=1024", "sm:size=1024", 1.05},
    {GOAL_WRONG_SAMPLES, "@dense", "exact:samples=32", NULL, 0},
    {GOAL_WRONG_SAMPLES, "@butterfly", "exact:samples=32", NULL, 0},
    {GOAL_WRONG_SAMPLES, "@tree", "exact:samples=32", NULL, 0},
    {GOAL_WRONG_SAMPLES, "@ball", "exact:samples=32", NULL, 0},
    {GOAL_VISIBILITY_GAIN, "@dense", "exact:samples=32", "reference:samples=32,tracer=embree", 2},
    {GOAL_VISIBILITY_GAIN, "@tree", "exact:samples=32", "reference:samples=32,tracer=embree", 1.5},
    {GOAL_VISIBILITY_GAIN, "@ball", "exact:samples=32", "reference:samples=32,tracer=embree", 1.5},
    {GOAL_VISIBILITY_GAIN_MOVING, "@dense", "exact:samples=32", "reference:samples=32,tracer=embree", 1.3},
    {GOAL_STILL_RATIO, "@dense", "exact:samples=1", "sm:size=1024", 1.5},
    {0},
};

const struct bench_suite bench_suite_paper = {
    .name = "paper",
    .summary = "tables and figures of the coverage paper, with errors: minutes",
    .tables = (const struct bench_table *const[]){&bench_table_dense, &bench_table_models, &bench_table_beside, &bench_table_bias,
                                                  NULL},
    .figures = (const struct bench_figure *const[]){&bench_figure_wings, &bench_figure_pairs, &bench_figure_sizes,
                                                    &bench_figure_recovery, NULL},
    .goals = bench_goals,
    .frames = 15,
    .width = 1280,
    .height = 720,
};
