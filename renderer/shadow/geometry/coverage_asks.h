/* What triangles say about points, asked in any order: each answer is looked up eight at a time (map_looks.h), and what they say together
 * depends on no order. */
#pragma once

#include "scene/adjacency.h"
#include "shadow/geometry/coverage_lists.h"
#include "shadow/geometry/map_looks.h"

enum {
    ASKS_POINTS = 256, /* at a time */
    ASKS_QUEUE = 512,
};

/* What is known of a point. */
enum {
    POINT_DARK = 1,    /* something lies before it */
    POINT_HELD = 2,    /* its own triangle was met, or one that may shadow it holds it and does not */
    POINT_COVERED = 4, /* a triangle holds it, whatever it may do */
};

/* A triangle to be asked about a point; or one that was, may shadow the point and does not hold it: the beginning of a way to the one that
 * does. */
struct coverage_pair {
    uint32_t point, triangle;
};
struct coverage_way {
    uint32_t point, triangle, before; /* where the way comes from; SCENE_NONE: it begins here */
    int32_t beyond;                   /* edge, as in map_looks.h; and area */
    double area;
};

/* A thread's work space. */
struct coverage_asks {
    const struct geometry_map *map;
    const struct adjacency *adjacency; /* NULL: no recovery */
    const struct map_point *points;
    uint32_t hint;
    size_t pair_count, way_count;
    uint8_t known[ASKS_POINTS];
    struct coverage_pair pairs[ASKS_QUEUE];
    struct coverage_way ways[ASKS_QUEUE + 1];
};

/* For `count` points of one map, ASKS_POINTS at the most. */
void coverage_asks_open(struct coverage_asks *a, const struct geometry_map *m, const struct adjacency *adjacency,
                        const struct map_point *points, size_t count);
/* Triangle `id` (MAP_OFF_EDGE taken off), once a point. */
void coverage_asks_put(struct coverage_asks *a, uint32_t point, uint32_t id);
/* After these, all that was put is known: without recovery, and with. */
void coverage_asks_finish_pairs(struct coverage_asks *a);
void coverage_asks_finish(struct coverage_asks *a);
