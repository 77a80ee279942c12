/* Conservative rasterization: which texels a triangle touches, not only those whose centre it covers. One tool for all that keep lists by texel.
 *
 * Our own, on the CPU: software rasterizers have none (no GL_NV_conservative_raster, no GL_INTEL_conservative_rasterization), and two cores
 * bin a million triangles in the time that they rasterize or trace a map. A texel is touched where every edge's half-plane, moved outward by
 * half a texel along both axes and by the margin, holds the texel's centre (Hasselgren, Akenine-Moeller and Ohlsson 2005, "Conservative
 * Rasterization", GPU Gems 2, chapter 42), within the triangle's bounding box.
 *
 * Margin: 1/64 texel, more than rounding moves an edge by: corners of single precision within a side of a map of at most 16384 texels are
 * off by 2^-10, and three roundings of an edge equation by at most 2^-7 of a texel. No touched texel is ever missed (test_conservative.c);
 * texels that come out touched and are not lie within the margin of the triangle, or beside one of its corners. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define CONSERVATIVE_MARGIN (1.0f / 64)

/* A triangle over a window of texels; texel (x, y) of the window has its centre at (x + 0.5, y + 0.5). */
struct conservative {
    float a[3], b[3], c[3]; /* of edge k at texel (x, y)'s centre: a x + b y + c >= 0 inside */
    float reach[3];         /* touched: >= -reach */
    int32_t x0, y0, x1, y1; /* texels of its bounding box, clipped to the window; inclusive */
    float turn;             /* 1 or -1: the sign of its area; 1 where it has none */
    float area;             /* twice the projected area, texels^2, >= 0 */
};

/* Of three; fminf() and fmaxf() are calls, for the sake of what is not a number. */
#define CONSERVATIVE_LEAST(v) ((v)[0] < (v)[1] ? (v)[0] < (v)[2] ? (v)[0] : (v)[2] : (v)[1] < (v)[2] ? (v)[1] : (v)[2])
#define CONSERVATIVE_MOST(v)  ((v)[0] > (v)[1] ? (v)[0] > (v)[2] ? (v)[0] : (v)[2] : (v)[1] > (v)[2] ? (v)[1] : (v)[2])

/* Corners in texels from the window's corner, finite. False: it touches nothing in the window of width x height texels. */
static inline __attribute__((always_inline)) bool conservative_setup(struct conservative *t, const float x[3], const float y[3],
                                                                     int32_t width, int32_t height)
{
    const float m = CONSERVATIVE_MARGIN;
    float left = CONSERVATIVE_LEAST(x) - m, right = CONSERVATIVE_MOST(x) + m;
    float top = CONSERVATIVE_LEAST(y) - m, bottom = CONSERVATIVE_MOST(y) + m;
    if (!(left < (float)width && right >= 0 && top < (float)height && bottom >= 0))
        return false;
    t->x0 = left > 0 ? (int32_t)left : 0;
    t->y0 = top > 0 ? (int32_t)top : 0;
    t->x1 = right < (float)width ? (int32_t)right : width - 1;
    t->y1 = bottom < (float)height ? (int32_t)bottom : height - 1;
    float area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    t->turn = area < 0 ? -1.0f : 1.0f;
    t->area = fabsf(area);
    for (int k = 0; k < 3; k++) {
        int j = k == 2 ? 0 : k + 1;
        t->a[k] = t->turn * (y[k] - y[j]);
        t->b[k] = t->turn * (x[j] - x[k]);
        t->c[k] = t->a[k] * (0.5f - x[k]) + t->b[k] * (0.5f - y[k]);
        t->reach[k] = (0.5f + m) * (fabsf(t->a[k]) + fabsf(t->b[k]));
    }
    return true;
}

/* Edge k at eight texels of row y from column x on. */
#define CONSERVATIVE_EDGE(t, k, columns, y) ((t)->a[k] * (columns) + ((t)->b[k] * (float)(y) + (t)->c[k]))

/* All bits of a lane set where the texel is touched. `edge`: CONSERVATIVE_EDGE of each. */
#define CONSERVATIVE_TOUCHED(t, edge, columns)                                                       \
    (((edge)[0] >= -(t)->reach[0]) & ((edge)[1] >= -(t)->reach[1]) & ((edge)[2] >= -(t)->reach[2]) & \
     ((columns) >= (float)(t)->x0) & ((columns) <= (float)(t)->x1))

/* The same as bits 0..7, for callers that want no vectors. */
unsigned conservative_row(const struct conservative *t, int32_t x, int32_t y);

/* Whether the texel with its low corner at (x, y) is touched: the same rule for one texel, corners in the same coordinates. */
bool conservative_touches(const float px[3], const float py[3], float x, float y);
