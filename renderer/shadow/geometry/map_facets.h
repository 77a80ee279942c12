/* Eight triangles over a tile of a geometry map, set up together: what map_tile_code.h marks texels by, a lane each. */
#pragma once

#include "shadow/geometry/light_lanes.h"

/* Ranks: below 0 over the centre, minus the nearness there; else the distance from the centre in steps, and within a step the nearer to the
 * light first: of two triangles that meet in an outline, the one that the light sees. The smaller is kept, of equals the first: a tile's triangles come in one order always. */
#define RANK_STEPS 8.0f /* a texel */

struct map_facets {
    struct light_lanes at;          /* corners, texels from the tile's */
    lanes a[3], b[3], c[3];         /* of edge k at texel (x, y)'s centre: a x + b y + c >= 0 inside */
    lanes least[3];                 /* touched: at least this (conservative.h's -reach) */
    lanes inverse[3];               /* RANK_STEPS / length of each edge */
    lanes n, nx, ny;                /* nearness at texel (x, y)'s centre: n + nx x + ny y */
    lanes most, slack;              /* the nearest corner's; by how much a texel may exceed its centre */
    lanes behind;                   /* in (0, 1): more for farther from the light */
    lane_ints x0, y0, x1, y1;       /* texels of its bounding box, clipped to the tile; inclusive */
    lanes left, top, right, bottom; /* the same */
    lane_ints over;                 /* all bits: it touches the tile's square at all */
    lane_ints thin;                 /* all bits: may have no area */
    lane_ints wide;                 /* all bits: eight texels or more, along either axis */
    /* Of wide ones: edge k crosses row y at at_row + step y; what lies farther left than `before` beyond that is outside, or farther right than
     * `after`. */
    lanes at_row[3], step[3], before[3], after[3];
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
    lanes x0 = LANES_LEAST(f->at.x) - CONSERVATIVE_MARGIN, x1 = LANES_MOST(f->at.x) + CONSERVATIVE_MARGIN;
    lanes y0 = LANES_LEAST(f->at.y) - CONSERVATIVE_MARGIN, y1 = LANES_MOST(f->at.y) + CONSERVATIVE_MARGIN;
    f->over = (x0 < side) & (x1 >= 0) & (y0 < side) & (y1 >= 0);
    lanes last = lanes_all(side - 1), none = {};
    f->x0 = lanes_truncate(lanes_max(x0, none));
    f->y0 = lanes_truncate(lanes_max(y0, none));
    f->x1 = lanes_truncate(lanes_min(x1, last));
    f->y1 = lanes_truncate(lanes_min(y1, last));
    f->most = LANES_MOST(f->at.n);
}

/* The rest. `nearest`: the nearness of the map's near plane. */
static inline __attribute__((always_inline)) void map_facets_set(struct map_facets *f, float nearest, float side)
{
    const float m = CONSERVATIVE_MARGIN;
    const lanes *x = f->at.x, *y = f->at.y, *n = f->at.n;
    lanes area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    lane_ints turn = (area < 0) & ((lane_ints){} + INT32_MIN);
    lanes longest = {}, size = lanes_abs(area), sign = (lanes)((lane_ints)lanes_all(1.0f) | turn);
    for (int k = 0; k < 3; k++) {
        int j = k == 2 ? 0 : k + 1;
        f->a[k] = (lanes)((lane_ints)(y[k] - y[j]) ^ turn);
        f->b[k] = (lanes)((lane_ints)(x[j] - x[k]) ^ turn);
        f->c[k] = f->a[k] * (0.5f - x[k]) + f->b[k] * (0.5f - y[k]);
        f->least[k] = -(0.5f + m) * (lanes_abs(f->a[k]) + lanes_abs(f->b[k]));
        lanes length = f->a[k] * f->a[k] + f->b[k] * f->b[k] + 1e-30f;
        length = lanes_sqrt(length);
        f->inverse[k] = RANK_STEPS / length;
        longest = k == 0 ? f->inverse[k] : lanes_min(longest, f->inverse[k]);
    }
    longest *= 1 / RANK_STEPS;
    f->thin = (size * longest * longest <= 1e-4f) | (size <= 1e-6f);
    lanes scale = sign / size, u = n[1] - n[0], v = n[2] - n[0];
    f->nx = (u * (y[2] - y[0]) - v * (y[1] - y[0])) * scale;
    f->ny = (v * (x[1] - x[0]) - u * (x[2] - x[0])) * scale;
    f->n = n[0] + f->nx * (0.5f - x[0]) + f->ny * (0.5f - y[0]);
    /* What rounding makes of a slope is a fraction of it; the corners bound the rest. */
    lanes slopes = lanes_abs(f->nx) + lanes_abs(f->ny);
    f->slack = (0.5f + m) * slopes;
    f->slack += 0x1p-18f * slopes * (lanes_abs(x[0]) + lanes_abs(y[0]) + side);
    lane_ints flat = ~(f->slack < lanes_all(INFINITY)); /* seen edge-on */
    lanes none = {};
    f->nx = lanes_pick(flat, none, f->nx);
    f->ny = lanes_pick(flat, none, f->ny);
    f->slack = lanes_pick(flat, none, f->slack);
    f->n = lanes_pick(flat, f->most, f->n);
    f->wide = (f->x1 - f->x0 >= 8) | (f->y1 - f->y0 >= 8);
    f->left = lanes_from(f->x0);
    f->top = lanes_from(f->y0);
    f->right = lanes_from(f->x1);
    f->bottom = lanes_from(f->y1);
    f->behind = nearest / (nearest + (n[0] + n[1] + n[2]) * (1.0f / 3));
}

/* What of a row the edges leave, a little more than less: most of a long thin triangle's box is empty. */
static inline __attribute__((always_inline)) void map_facets_spans(struct map_facets *f)
{
    for (int k = 0; k < 3; k++) {
        lanes inverse = 1 / f->a[k], at = (f->least[k] - f->c[k]) * inverse, step = -f->b[k] * inverse;
        /* Steep enough that roundings of the crossing, and of the edge there, are less than 1/16 texel. */
        lane_ints sure = (lanes_abs(at) < 1e5f) & (lanes_abs(step) < 1e3f);
        lanes far = lanes_all(INFINITY), none = {};
        f->before[k] = lanes_pick(sure & (f->a[k] > 0), none - 0.125f, -far);
        f->after[k] = lanes_pick(sure & (f->a[k] < 0), none + 0.125f, far);
        f->at_row[k] = lanes_pick(sure, at, none);
        f->step[k] = lanes_pick(sure, step, none);
    }
}
