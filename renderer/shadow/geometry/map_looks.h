/* What triangles say about points, eight pairs at a time: where a point lies against a triangle's projection, and which of them is nearer to the
 * light. The arithmetic is that of light_triangle_hit() and light_triangle_sides(). */
#pragma once

#include "shadow/geometry/geometry_map.h"
#include "shadow/geometry/geometry_points.h"

enum { LOOKS = 8 };

struct map_looks {
    double area[LOOKS]; /* found; as in struct light_sides */
    /* Given, of each pair. */
    float x[LOOKS], y[LOOKS], n[LOOKS]; /* of the point */
    uint32_t triangle[LOOKS];           /* drawn id */
    /* Found. */
    /* A bit a pair. */
    unsigned holds;      /* its projection holds the point, and has no hole there */
    unsigned before;     /* shadows the point if it holds it */
    unsigned may_shadow; /* some corner of it lies before the point */
    unsigned wild;
    /* The edge that the point lies beyond, most so; -1: it lies within. */
    int32_t beyond[LOOKS] __attribute__((aligned(32)));
} __attribute__((aligned(64)));

/* The eight's first `count`, of which there is one at least; the others' bits are 0. `hint`: a thread's own. */
void map_look(const struct geometry_map *m, struct map_looks *l, unsigned count, uint32_t *hint);

static inline void map_looks_put(struct map_looks *l, unsigned k, const struct map_point *p, uint32_t triangle)
{
    l->x[k] = p->x;
    l->y[k] = p->y;
    l->n[k] = p->n;
    l->triangle[k] = triangle;
}
