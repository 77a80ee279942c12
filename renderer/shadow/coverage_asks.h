/* What a list's triangles say about a point, four at a time: geometry_ask() of each, in the same arithmetic. */
#pragma once

#include "scene/adjacency.h"
#include "shadow/coverage_lists.h"
#include "shadow/coverage_recovery.h"
#include "shadow/geometry_maps.h"

/* What they say together. */
struct coverage_answer {
    bool dark; /* one of them lies before the point; nothing else is known then */
    bool held; /* the point's own triangle is one of them, or one that may shadow it holds it and does not */
    /* Those that may shadow the point and do not hold it, as ways to those that do. */
    unsigned besides;
    struct coverage_way beside[COVERAGE_NODES_MAX];
};

void coverage_ask(const struct geometry_map *m, const uint32_t *ids, unsigned count, const struct map_point *p, uint32_t *hint,
                  struct coverage_answer *out);
