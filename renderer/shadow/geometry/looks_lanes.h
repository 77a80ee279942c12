/* Eight pairs of a triangle and a point (map_looks.h). Included by the kernels only (geometry_plain.c, geometry_avx2.c). */
#pragma once

#include "base/lanes.h"
#include "shadow/geometry/light_lanes.h"
#include "shadow/geometry/map_looks.h"

/* As many doubles as a vector holds: wider ones the compiler takes apart, badly. */
enum { LOOK_PART = 4 };
typedef double part_doubles __attribute__((vector_size(8 * LOOK_PART), may_alias));
typedef int64_t part_longs __attribute__((vector_size(8 * LOOK_PART), may_alias));
typedef float part_floats __attribute__((vector_size(4 * LOOK_PART), may_alias));
typedef int32_t part_ints __attribute__((vector_size(4 * LOOK_PART), may_alias));

/* geometry_before(). */
LANES_INLINE lane_ints looks_before(const struct geometry_map *m, lanes occluder, lanes n)
{
    return occluder > n + 0x1p-20f * lanes_abs(occluder) + m->mesh.rounding;
}

/* The most negative of the edges; -1 where none is. */
LANES_INLINE part_longs edge_beyond(const part_doubles e[3], part_doubles area)
{
    part_longs turn = (area < 0) & INT64_MIN, beyond = ~(part_longs){};
    part_doubles most = {};
    for (int k = 0; k < 3; k++) {
        part_doubles edge = (part_doubles)((part_longs)e[k] ^ turn);
        part_longs more = edge < most;
        most = (part_doubles)(((part_longs)edge & more) | ((part_longs)most & ~more));
        beyond = (k & more) | (beyond & ~more);
    }
    return beyond;
}

/* What is worked out in double. */
struct look_parts {
    lane_ints holds;
    lanes nearness; /* where it holds */
};

#define WIDE_PART(v, part) __builtin_convertvector(((const part_floats *)(const void *)&(v))[part], part_doubles)

LANES_INLINE void look_at_part(const struct light_lanes *c, struct map_looks *l, int part, struct look_parts *out)
{
    part_doubles x[3], y[3], e[3];
    for (int k = 0; k < 3; k++) {
        x[k] = WIDE_PART(c->x[k], part) - WIDE_PART(l->x, part);
        y[k] = WIDE_PART(c->y[k], part) - WIDE_PART(l->y, part);
    }
    for (int k = 0; k < 3; k++) {
        int j = k == 2 ? 0 : k + 1;
        e[k] = x[k] * y[j] - y[k] * x[j];
    }
    part_doubles sum = e[1] + e[2] + e[0], area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    part_longs holds = ((e[0] >= 0) & (e[1] >= 0) & (e[2] >= 0)) | ((e[0] <= 0) & (e[1] <= 0) & (e[2] <= 0));
    part_doubles near =
        e[1] / sum * WIDE_PART(c->n[0], part) + e[2] / sum * WIDE_PART(c->n[1], part) + e[0] / sum * WIDE_PART(c->n[2], part);
    ((part_ints *)&out->holds)[part] = __builtin_convertvector(holds & (sum != 0), part_ints);
    ((part_floats *)&out->nearness)[part] = __builtin_convertvector(near, part_floats);
    ((part_ints *)l->beyond)[part] = __builtin_convertvector(edge_beyond(e, area), part_ints);
    ((part_doubles *)l->area)[part] = area;
}

static void look_at_eight(const struct geometry_map *m, struct map_looks *l, uint32_t *hint)
{
    struct light_triangle t[LOOKS];
    struct light_lanes c;
    struct look_parts parts;
#pragma GCC unroll 8
    for (int i = 0; i < LOOKS; i++)
        t[i] = light_part_triangle(light_mesh_part(&m->mesh, l->triangle[i], hint), l->triangle[i]);
    light_lanes_load(t, &c);
    for (int part = 0; part < LOOKS / LOOK_PART; part++)
        look_at_part(&c, l, part, &parts);
    lanes n = lanes_load(l->n), sum = c.x[0] + c.x[1] + c.x[2];
    l->holds = lanes_bits(parts.holds);
    l->before = lanes_bits(looks_before(m, parts.nearness, n));
    l->may_shadow = lanes_bits(looks_before(m, c.n[0], n) | looks_before(m, c.n[1], n) | looks_before(m, c.n[2], n));
    l->wild = lanes_bits(sum != sum);
}
