/* Eight triangles over a tile of a geometry map, set up together: what map_tile_code.h marks texels by, a lane each. */
#pragma once

#include "shadow/light_lanes.h"

/* Ranks: below 0 over the centre, minus the nearness there; else the distance from the centre in steps, and within a step the nearer to the
 * light first: of two triangles that meet in an outline, the one that the light sees. The smaller is kept, of equals the first: a tile's triangles come in one order always. */
#define RANK_STEPS 8.0f /* a texel */

struct map_facets {
    struct light_lanes at;                /* corners, texels from the tile's */
    lanes_float a[3], b[3], c[3];         /* of edge k at texel (x, y)'s centre: a x + b y + c >= 0 inside */
    lanes_float least[3];                 /* touched: at least this (conservative.h's -reach) */
    lanes_float inverse[3];               /* RANK_STEPS / length of each edge */
    lanes_float n, nx, ny;                /* nearness at texel (x, y)'s centre: n + nx x + ny y */
    lanes_float most, slack;              /* the nearest corner's; by how much a texel may exceed its centre */
    lanes_float behind;                   /* in (0, 1): more for farther from the light */
    lanes_int x0, y0, x1, y1;             /* texels of its bounding box, clipped to the tile; inclusive */
    lanes_float left, top, right, bottom; /* the same */
    lanes_int over;                       /* all bits: it touches the tile's square at all */
    lanes_int thin;                       /* all bits: may have no area */
    lanes_int wide;                       /* all bits: eight texels or more, along either axis */
    /* Of wide ones: edge k crosses row y at at_row + step y; what lies farther left than `before` beyond that is outside, or farther right than
     * `after`. */
    lanes_float at_row[3], step[3], before[3], after[3];
};

/* Corners, box, nearest corner: enough to tell whether a triangle is hidden. */
static inline __attribute__((always_inline)) void map_facets_box(struct map_facets *f, const struct light_triangle *t, float left,
                                                                 float top, float side)
{
    light_lanes_load(t, &f->at);
    for (int k = 0; k < 3; k++) {
        f->at.x[k] -= left;
        f->at.y[k] -= top;
    }
    lanes_float x0 = LANES_LEAST(f->at.x) - CONSERVATIVE_MARGIN, x1 = LANES_MOST(f->at.x) + CONSERVATIVE_MARGIN;
    lanes_float y0 = LANES_LEAST(f->at.y) - CONSERVATIVE_MARGIN, y1 = LANES_MOST(f->at.y) + CONSERVATIVE_MARGIN;
    f->over = (x0 < side) & (x1 >= 0) & (y0 < side) & (y1 >= 0);
    lanes_float last = LANES_ALL(side - 1), none = {};
    f->x0 = __builtin_convertvector(LANES_MAX(x0, none), lanes_int);
    f->y0 = __builtin_convertvector(LANES_MAX(y0, none), lanes_int);
    f->x1 = __builtin_convertvector(LANES_MIN(x1, last), lanes_int);
    f->y1 = __builtin_convertvector(LANES_MIN(y1, last), lanes_int);
    f->most = LANES_MOST(f->at.n);
}

/* The rest. `nearest`: the nearness of the map's near plane. */
static inline __attribute__((always_inline)) void map_facets_set(struct map_facets *f, float nearest, float side)
{
    const float m = CONSERVATIVE_MARGIN;
    const lanes_float *x = f->at.x, *y = f->at.y, *n = f->at.n;
    lanes_float area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    lanes_int turn = (area < 0) & ((lanes_int){} + INT32_MIN);
    lanes_float longest = {}, size = LANES_ABS(area), sign = (lanes_float)((lanes_int)LANES_ALL(1.0f) | turn);
    for (int k = 0; k < 3; k++) {
        int j = k == 2 ? 0 : k + 1;
        f->a[k] = (lanes_float)((lanes_int)(y[k] - y[j]) ^ turn);
        f->b[k] = (lanes_float)((lanes_int)(x[j] - x[k]) ^ turn);
        f->c[k] = f->a[k] * (0.5f - x[k]) + f->b[k] * (0.5f - y[k]);
        f->least[k] = -(0.5f + m) * (LANES_ABS(f->a[k]) + LANES_ABS(f->b[k]));
        lanes_float length = f->a[k] * f->a[k] + f->b[k] * f->b[k] + 1e-30f;
        LANES_ROOT(length);
        f->inverse[k] = RANK_STEPS / length;
        longest = k == 0 ? f->inverse[k] : LANES_MIN(longest, f->inverse[k]);
    }
    longest *= 1 / RANK_STEPS;
    f->thin = (size * longest * longest <= 1e-4f) | (size <= 1e-6f);
    lanes_float scale = sign / size, u = n[1] - n[0], v = n[2] - n[0];
    f->nx = (u * (y[2] - y[0]) - v * (y[1] - y[0])) * scale;
    f->ny = (v * (x[1] - x[0]) - u * (x[2] - x[0])) * scale;
    f->n = n[0] + f->nx * (0.5f - x[0]) + f->ny * (0.5f - y[0]);
    /* What rounding makes of a slope is a fraction of it; the corners bound the rest. */
    lanes_float slopes = LANES_ABS(f->nx) + LANES_ABS(f->ny);
    f->slack = (0.5f + m) * slopes;
    f->slack += 0x1p-18f * slopes * (LANES_ABS(x[0]) + LANES_ABS(y[0]) + side);
    lanes_int flat = ~(f->slack < LANES_ALL(INFINITY)); /* seen edge-on */
    lanes_float none = {};
    f->nx = LANES_IF(flat, none, f->nx);
    f->ny = LANES_IF(flat, none, f->ny);
    f->slack = LANES_IF(flat, none, f->slack);
    f->n = LANES_IF(flat, f->most, f->n);
    f->wide = (f->x1 - f->x0 >= 8) | (f->y1 - f->y0 >= 8);
    f->left = __builtin_convertvector(f->x0, lanes_float);
    f->top = __builtin_convertvector(f->y0, lanes_float);
    f->right = __builtin_convertvector(f->x1, lanes_float);
    f->bottom = __builtin_convertvector(f->y1, lanes_float);
    f->behind = nearest / (nearest + (n[0] + n[1] + n[2]) * (1.0f / 3));
}

/* What of a row the edges leave, a little more than less: most of a long thin triangle's box is empty. */
static inline __attribute__((always_inline)) void map_facets_spans(struct map_facets *f)
{
    for (int k = 0; k < 3; k++) {
        lanes_float inverse = 1 / f->a[k], at = (f->least[k] - f->c[k]) * inverse, step = -f->b[k] * inverse;
        /* Steep enough that roundings of the crossing, and of the edge there, are less than 1/16 texel. */
        lanes_int sure = (LANES_ABS(at) < 1e5f) & (LANES_ABS(step) < 1e3f);
        lanes_float far = LANES_ALL(INFINITY), none = {};
        f->before[k] = LANES_IF(sure & (f->a[k] > 0), none - 0.125f, -far);
        f->after[k] = LANES_IF(sure & (f->a[k] < 0), none + 0.125f, far);
        f->at_row[k] = LANES_IF(sure, at, none);
        f->step[k] = LANES_IF(sure, step, none);
    }
}
