/* Which triangles may lie between a point and the light: a grid seen from the light. A directional light has one face, orthographic; a
 * point or spot light one perspective face where all fits into a cone of 120 degrees, else the six of a cube.
 *
 * A face is a pyramid of grids: level 0 has side x side cells, each further level half as many a side, the last one. A triangle is
 * listed at the finest level at which its box spans at most two cell widths: no triangle has more than nine entries, whatever its size
 * (EXACT.md's "insert at the level where it spans 2 x 2"). Border cells reach to infinity, so that level 0 may be spread over where most
 * triangles are. Within a cell: nearest to the light first, then by id, whichever thread came first.
 *
 * All boxes are rounded outwards, and cells are found from boxes by one monotone function: two boxes that overlap share a cell. */
#pragma once

#include <math.h>

#include "base/dmath.h"
#include "exact/triangles.h"

struct job_pool;

enum { LIGHT_FACES_MAX = 6, LIGHT_LEVELS_MAX = 13 };

/* u, v: on the plane at distance 1 from a point or spot light; scene units for a directional one. near, far: along face.forward. */
struct light_box {
    float u0, u1, v0, v1, near, far;
};

struct light_face {
    struct dvec3 right, up, forward;
    double limit;                             /* |u| and |v| within the face are not more: INFINITY if this is the only face */
    float u_start, v_start, u_scale, v_scale; /* level 0: cell = (u - start) * scale */
    uint32_t side;                            /* cells of level 0 in each direction; a power of two */
    uint32_t occupied;                        /* bit a level: it has entries */
    uint32_t level_first[LIGHT_LEVELS_MAX];   /* first cell of each level */
};

/* A triangle on a face. */
struct light_ref {
    float u0, u1, v0, v1, near;
    uint32_t id;
};

struct light_grid {
    bool directional;
    struct dvec3 position; /* not directional */
    unsigned face_count;
    struct light_face faces[LIGHT_FACES_MAX];
    struct light_ref *refs;
    uint32_t ref_count;
    uint32_t *first; /* entries of each cell, one more than cells */
    uint32_t cell_count;
    uint32_t *entries; /* indices of refs */
    size_t bytes;
};

enum face_part { FACE_NONE, FACE_SOME };

/* Box on a face of the convex hull of `points`, each off by at most `slack`; FACE_NONE: certainly outside the face. */
enum face_part light_face_box(const struct light_grid *grid, const struct light_face *face, const struct dvec3 *points, int count,
                              double slack, struct light_box *box);

/* `memory`: bytes it may take, 0: as it likes; with less, its cells get larger. False when memory is out, or `memory` too little:
 * light_grid_finish() in any case. */
bool light_grid_init(struct light_grid *grid, const struct triangles *triangles, const struct light *light, size_t memory,
                     struct job_pool *pool);
void light_grid_finish(struct light_grid *grid);

/* Bytes below which light_grid_init() refuses. */
size_t light_grid_least_bytes(const struct triangles *triangles);

/* A float certainly not above, or not below x. */
static inline float box_below(double x) { return (float)x - (fabsf((float)x) * 0x1p-23f + 1e-37f); }
static inline float box_above(double x) { return (float)x + (fabsf((float)x) * 0x1p-23f + 1e-37f); }

static inline uint32_t light_cell(float u, float start, float scale, uint32_t side)
{
    float cell = (u - start) * scale;
    return cell > 0 ? cell < (float)side ? (uint32_t)cell : side - 1 : 0;
}
