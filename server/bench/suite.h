/* The suites as data: a suite is a list of tables, a table says which scenes meet which algorithms and what is measured of each pair.
 * suites/ holds them and is the one place here that names shadow systems; what is not registered is left out by the plan. */
#pragma once

#include <stddef.h>

enum bench_measure {
    MEASURE_STILL = 1,      /* frames, nothing moves */
    MEASURE_MOVING = 2,     /* frames, the light turns */
    MEASURE_PASSES = 4,     /* both again with a finish after each pass */
    MEASURE_POINT = 8,      /* error against point */
    MEASURE_SAMPLES32 = 16, /* error against samples32 */
    MEASURE_AREALIGHT = 32, /* error against arealight */
};

enum table_shape {
    SHAPE_ROWS,    /* a row for each algorithm, below its scene */
    SHAPE_MATRIX,  /* scenes down, algorithms across, errors in the cells */
    SHAPE_SCALING, /* a curve for each algorithm over what varies */
};

/* What a scaling table varies. */
enum table_axis { AXIS_NONE, AXIS_TRIANGLES, AXIS_MAP_SIZE, AXIS_PIXELS, AXIS_LIGHTS };

/* Lists are ended by NULL (or 0). */
struct bench_table {
    const char *name;  /* [a-z0-9_]+ */
    const char *title; /* a heading */
    const char *note;  /* a sentence or two under it */
    enum table_shape shape;
    enum table_axis axis;
    /* Scenes as scene_load() takes them; "@dense" and the like (models.h); "builtin:hard-*": every built-in scene that begins so. */
    const char *const *scenes;
    /* As --algorithm takes them; "*": every registered system; "*:size=256": with that where it has the parameter. */
    const char *const *algorithms;
    unsigned measures; /* enum bench_measure, or-ed */
    double size;       /* times the run's picture size; 0: 1 */
    const double *sizes;
    const unsigned *lights; /* the scene's first light, turned into so many; NULL: the scene's own */
    const char *baseline;   /* the system with which those of the same map size are compared; NULL: none */
    const char *heavy;      /* why --quick leaves it out; NULL: it does not */
};

enum figure_kind {
    FIGURE_PICTURES, /* what each algorithm draws, and how it differs from point */
    FIGURE_PAIRS,    /* how each two of them differ from one another */
};

/* Pictures side by side, cut out where the first algorithm is most wrong. */
struct bench_figure {
    const char *name, *title, *note;
    enum figure_kind kind;
    const char *scene;             /* as in a table */
    const char *const *algorithms; /* ended by NULL */
};

/* Of the targets that the project set itself: subject against object. */
enum goal_kind {
    GOAL_ERROR_RATIO,     /* misclassified pixels against point, over the least of the object's at the same map size */
    GOAL_MOVING_RATIO,    /* median of the ratios of frame times, light moving */
    GOAL_STILL_RATIO,     /* the same, light still */
    GOAL_WRONG_SAMPLES,   /* mask bits that differ from samples32 */
    GOAL_VISIBILITY_GAIN, /* the object's visibility_ms over the subject's, light still: at least */
    GOAL_VISIBILITY_GAIN_MOVING,
};

struct bench_goal {
    enum goal_kind kind;
    const char *scene; /* as in a table; NULL: all that both were measured on */
    const char *subject, *object;
    double bound;
};

struct bench_suite {
    const char *name, *summary;
    const struct bench_table *const *tables;
    const struct bench_figure *const *figures; /* may be NULL */
    const struct bench_goal *goals;            /* ended by subject = NULL; may be NULL */
    unsigned frames;                           /* timed of each cell */
    unsigned width, height;
};

extern const struct bench_suite *const bench_suites[]; /* ended by NULL */

/* NULL if there is none of that name. */
const struct bench_suite *bench_suite_find(const char *name);
