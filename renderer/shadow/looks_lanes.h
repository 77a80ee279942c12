/* Eight pairs of a triangle and a point (map_looks.h). Included by the kernels only (geometry_plain.c, geometry_avx2.c). */
#pragma once

#include "base/lanes.h"
#include "shadow/light_lanes.h"
#include "shadow/map_looks.h"

typedef double half_doubles __attribute__((vector_size(32), may_alias));
typedef int64_t half_longs __attribute__((vector_size(32), may_alias));
typedef int32_t half_ints __attribute__((vector_size(16), may_alias));

#define LOW_HALF(v)  __builtin_convertvector(__builtin_shufflevector(v, v, 0, 1, 2, 3), half_doubles)
#define HIGH_HALF(v) __builtin_convertvector(__builtin_shufflevector(v, v, 4, 5, 6, 7), half_doubles)

/* geometry_before(). */
LANES_INLINE lane_ints looks_before(const struct geometry_map *m, lanes occluder, lanes n)
{
    return occluder > n + 0x1p-20f * lanes_abs(occluder) + m->mesh.rounding;
}

/* Four of the eight, their corners relative to the points. */
struct look_half {
    half_doubles x[3], y[3], n[3];
    half_longs holds;
    lanes_quarter nearness; /* where it holds */
    half_doubles area;
    half_ints beyond;
};

LANES_INLINE void look_at_half(struct look_half *h)
{
    half_doubles e[3], none = {};
    for (int k = 0; k < 3; k++) {
        int j = k == 2 ? 0 : k + 1;
        e[k] = h->x[k] * h->y[j] - h->y[k] * h->x[j];
    }
    half_doubles sum = e[1] + e[2] + e[0];
    h->holds = ((e[0] >= 0) & (e[1] >= 0) & (e[2] >= 0)) | ((e[0] <= 0) & (e[1] <= 0) & (e[2] <= 0));
    h->holds &= sum != 0;
    half_doubles near = e[1] / sum * h->n[0] + e[2] / sum * h->n[1] + e[0] / sum * h->n[2];
    h->nearness = __builtin_convertvector(near, lanes_quarter);
    h->area = (h->x[1] - h->x[0]) * (h->y[2] - h->y[0]) - (h->x[2] - h->x[0]) * (h->y[1] - h->y[0]);
    half_longs turn = (h->area < 0) & INT64_MIN, beyond = ~(half_longs){};
    half_doubles most = none;
    for (int k = 0; k < 3; k++) {
        half_doubles edge = (half_doubles)((half_longs)e[k] ^ turn);
        half_longs more = edge < most;
        most = (half_doubles)(((half_longs)edge & more) | ((half_longs)most & ~more));
        beyond = (k & more) | (beyond & ~more);
    }
    h->beyond = __builtin_convertvector(beyond, half_ints);
}

LANES_INLINE void look_at_halves(const struct light_lanes *c, lanes px, lanes py, struct look_half *low, struct look_half *high)
{
    for (int k = 0; k < 3; k++) {
        low->x[k] = LOW_HALF(c->x[k]) - LOW_HALF(px);
        low->y[k] = LOW_HALF(c->y[k]) - LOW_HALF(py);
        low->n[k] = LOW_HALF(c->n[k]);
        high->x[k] = HIGH_HALF(c->x[k]) - HIGH_HALF(px);
        high->y[k] = HIGH_HALF(c->y[k]) - HIGH_HALF(py);
        high->n[k] = HIGH_HALF(c->n[k]);
    }
    look_at_half(low);
    look_at_half(high);
}

static void look_at_eight(const struct geometry_map *m, struct map_looks *l, uint32_t *hint)
{
    struct light_triangle t[LOOKS];
    struct light_lanes c;
    struct look_half low, high;
#pragma GCC unroll 8
    for (int i = 0; i < LOOKS; i++)
        t[i] = light_part_triangle(light_mesh_part(&m->mesh, l->triangle[i], hint), l->triangle[i]);
    light_lanes_load(t, &c);
    look_at_halves(&c, lanes_load(l->x), lanes_load(l->y), &low, &high);
    lanes n = lanes_load(l->n), sum = c.x[0] + c.x[1] + c.x[2];
    l->wild = lanes_bits(sum != sum);
    l->may_shadow = lanes_bits(looks_before(m, c.n[0], n) | looks_before(m, c.n[1], n) | looks_before(m, c.n[2], n));
    half_ints held_low = __builtin_convertvector(low.holds, half_ints),
              held_high = __builtin_convertvector(high.holds, half_ints);
    l->holds = lanes_bits(LANES_OF(held_low, held_high));
    l->before = lanes_bits(looks_before(m, LANES_OF(low.nearness, high.nearness), n));
    lane_ints_store(l->beyond, LANES_OF(low.beyond, high.beyond));
    *(half_doubles *)&l->area[0] = low.area;
    *(half_doubles *)&l->area[4] = high.area;
}
