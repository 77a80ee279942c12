/* A tile's code: which samples of a pixel, all inside a triangle with a mask, find it solid.
 *
 * The forms of a triangle's edges ab, bc, ca, seen from an apex, are at a point in the ratio of the weights of c, a and b where the line from
 * the apex through the point crosses the triangle; their sum is the determinant k of docs/truth.md's barycentrics, but for its sign. So both
 * the weights and what Moeller and Trumbore's formulas may make of them are known to within c / sum: the lines' own error E gives 2 E / sum;
 * rounding and the receiver's point's error e_p give u and v a numerator that is off by at most
 * (64u |s| |d| + e_p (|s| + |d| + e_p)) (|e1| + |e2|) and the determinant (64u |d| + e_p) |e1| |e2|, in sums of absolute components, where 16u
 * would do. While sum > 16 c the quotients add less than a fifth. */
#pragma once

#include "exact/simd.h"
#include "exact/tile.h"

/* Edges in the forms' own measure, so that they have one ratio; x, y within the pixel. */
struct hole_lines {
    lane4 g, gx, gy;
    double c; /* see above */
};

enum { HOLE_OPEN, HOLE_SOLID, HOLE_UNSURE, HOLE_WRAPPED };

#define HOLE_ROUNDING 0x1p-47 /* 64 u */

/* c without the lines' error: `s` and `d` sums of absolute components. */
static inline double hole_error(const struct masked *m, double s, double d, double point)
{
    return 1.2 *
           ((HOLE_ROUNDING * s * d + point * (s + d + point)) * (m->e1 + m->e2) + (HOLE_ROUNDING * d + point) * m->e1 * m->e2);
}

static inline int32_t hole_texel(double position)
{
    const double most = 0x1p29;
    position = position < most ? position : most;
    position = position > -most ? position : -most;
    return (int32_t)(position + 0x1p30) - (1 << 30);
}

/* `wanted` of which lie inside the triangle: those where it is solid, and those that only trace/hole.h can tell. */
static inline void hole_samples(const struct tile_scratch *scratch, const struct hole_map *map, const struct hole_lines *l,
                                uint32_t wanted, uint32_t *solid, uint32_t *unsure)
{
    const struct hole_mask *m = map->mask;
    _Alignas(64) int32_t column[32], row[32];
    _Alignas(64) uint32_t state[32];
    const bool clamp_s = m->wrap_s == WRAP_CLAMP_TO_EDGE, clamp_t = m->wrap_t == WRAP_CLAMP_TO_EDGE;
    const int32_t last_column = (int32_t)m->width - 1, last_row = (int32_t)m->height - 1;
    for (int i = 0; i < 32; i++) {
        double x = (double)scratch->x[i], y = (double)scratch->y[i];
        double ab = l->g[0] + x * l->gx[0] + y * l->gy[0], bc = l->g[1] + x * l->gx[1] + y * l->gy[1],
               ca = l->g[2] + x * l->gx[2] + y * l->gy[2];
        double sum = ab + bc + ca, k = 1 / sum, off = k * l->c, u = ca * k, v = ab * k;
        double s = map->s[0] + u * map->s[1] + v * map->s[2], t = map->t[0] + u * map->t[1] + v * map->t[2];
        /* Rounding to whole texels below moves a position by up to 2^-23. */
        double s_room = map->s_error + off * map->s_range + 0x1p-22, t_room = map->t_error + off * map->t_range + 0x1p-22;
        int32_t s0 = hole_texel(s - s_room), s1 = hole_texel(s + s_room);
        int32_t t0 = hole_texel(t - t_room), t1 = hole_texel(t + t_room);
        column[i] = s0;
        row[i] = t0;
        state[i] = (s0 == s1) & (t0 == t1) & (sum > 16 * l->c) ? HOLE_OPEN : HOLE_UNSURE;
    }
    for (int i = 0; i < 32; i++) {
        int32_t x = column[i] < 0 ? 0 : column[i] > last_column ? last_column : column[i];
        int32_t y = row[i] < 0 ? 0 : row[i] > last_row ? last_row : row[i];
        bool within = (clamp_s | (x == column[i])) & (clamp_t | (y == row[i]));
        uint32_t bit = m->solid[(uint32_t)y * m->row + ((uint32_t)x >> 5)] >> (x & 31) & 1;
        state[i] = state[i] == HOLE_UNSURE ? HOLE_UNSURE : within ? bit : HOLE_WRAPPED;
    }
    uint32_t wrapped = 0;
    *solid = *unsure = 0;
    for (int i = 0; i < 32; i += WIDTH) {
        *solid |= wide_same(state + i, HOLE_SOLID) << i;
        *unsure |= wide_same(state + i, HOLE_UNSURE) << i;
        wrapped |= wide_same(state + i, HOLE_WRAPPED) << i;
    }
    *solid &= wanted;
    *unsure &= wanted;
    for (wrapped &= wanted; wrapped; wrapped &= wrapped - 1) {
        unsigned i = (unsigned)__builtin_ctz(wrapped);
        *solid |=
            (uint32_t)hole_mask_at(m, texture_wrap(column[i], m->width, m->wrap_s), texture_wrap(row[i], m->height, m->wrap_t))
            << i;
    }
}
