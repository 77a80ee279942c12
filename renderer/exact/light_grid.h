/* Which triangles may lie between a point and the light: a grid seen from the light. A directional light has one face, orthographic; a
 * point or spot light one perspective face where all it has to do with lies well before a plane through it, else the six of a cube.
 *
 * A face is a pyramid of grids: level 0 has side x side cells, each further level half as many a side, the last one. A triangle is
 * kept once: at the finest level whose cells are as wide as its box, in the cell of the box's least corner. So a box is met by
 * triangles of its own cells and of one more row and column before them, and those of a row of cells lie one after the other in
 * memory. Memory does not depend on how large triangles are. Border cells reach to infinity, so that level 0 may be spread over where
 * most triangles are. Within a cell: by id, whichever thread came first.
 *
 * All boxes are rounded outwards, and cells are found from boxes by one monotone function. */
#pragma once

#include <math.h>

#include "base/dmath.h"
#include "exact/triangles.h"

struct job_pool;

enum { LIGHT_FACES_MAX = 6, LIGHT_LEVELS_MAX = 13, LIGHT_PADDING = 16, LIGHT_OTHERS = 8, LIGHT_BLOCK_SHIFT = 2 };

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
    uint32_t everywhere;                      /* bit a level: some of its boxes are too large for blocks */
    uint32_t level_first[LIGHT_LEVELS_MAX];   /* first cell of each level */
    float reach_u[LIGHT_LEVELS_MAX], reach_v[LIGHT_LEVELS_MAX]; /* no box of the level is wider, higher */
};

struct light_grid {
    bool directional;
    struct dvec3 position; /* not directional */
    unsigned face_count;
    struct light_face faces[LIGHT_FACES_MAX];
    float *u0, *u1, *v0, *v1, *near; /* boxes of triangles on faces, cell by cell; LIGHT_PADDING more may be read */
    uint32_t *ids;
    uint32_t ref_count;
    uint32_t *first; /* boxes of each cell, one more than cells */
    uint32_t cell_count;
    /* Learned as pictures ask, of each triangle, whoever looks at it: enum light_known, above it the light's side (0: not known, else 2 + the
     * sign); and what the former says of other triangles. */
    _Atomic uint32_t (*others)[LIGHT_OTHERS];
    _Atomic uint8_t *known;
    _Atomic uint16_t *blocks; /* face by face, 4 x 4 cells of level 0 each: bit a level: boxes of it meet the block */
    size_t bytes;
};

/* What may shadow some point of a triangle: nothing; the others; many, of which the others together shadowed some pixel of it. SCENE_NONE:
 * no more others. */
enum light_known { LIGHT_UNKNOWN, LIGHT_NOTHING, LIGHT_FEW, LIGHT_MANY, LIGHT_KNOWN_BITS = 2 };

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

/* Of two numbers; unlike fminf() without a call. */
static inline float box_min(float a, float b) { return a < b ? a : b; }
static inline float box_max(float a, float b) { return a > b ? a : b; }

static inline uint32_t light_blocks(const struct light_face *face)
{
    return face->side >> LIGHT_BLOCK_SHIFT ? face->side >> LIGHT_BLOCK_SHIFT : 1;
}

static inline uint32_t light_cell(float u, float start, float scale, uint32_t side)
{
    float cell = (u - start) * scale;
    return cell > 0 ? cell < (float)side ? (uint32_t)cell : side - 1 : 0;
}
