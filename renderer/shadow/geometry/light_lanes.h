/* Eight projected triangles at a time, a vector lane each. For callers that compile twice, for AVX2 and for any machine: the same arithmetic in the
 * same order, so the same bits. */
#pragma once

#include "base/lanes.h"
#include "shadow/geometry/conservative.h"
#include "shadow/geometry/light_mesh.h"

typedef float lanes_quarter __attribute__((vector_size(16)));

#define LANES_OF(low, high) __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7)

#define LANES_LEAST(v) lanes_min(lanes_min((v)[0], (v)[1]), (v)[2])
#define LANES_MOST(v)  lanes_max(lanes_max((v)[0], (v)[1]), (v)[2])

/* Corner k's coordinates, of each lane. */
struct light_lanes {
    lanes x[3], y[3], n[3];
};

static inline __attribute__((always_inline)) void light_lanes_corner(const struct light_triangle t[LANES], int k,
                                                                     struct light_lanes *out)
{
    lanes_quarter v[LANES];
#pragma GCC unroll 8
    for (int i = 0; i < LANES; i++)
        v[i] = *(const lanes_quarter *)(const void *)t[i].corner[k];
    lanes a = LANES_OF(v[0], v[4]), b = LANES_OF(v[1], v[5]), c = LANES_OF(v[2], v[6]), d = LANES_OF(v[3], v[7]);
    lanes ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
    lanes cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
    lanes ab_n = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
    lanes cd_n = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
    out->x[k] = __builtin_shufflevector(ab, cd, 0, 1, 8, 9, 4, 5, 12, 13);
    out->y[k] = __builtin_shufflevector(ab, cd, 2, 3, 10, 11, 6, 7, 14, 15);
    out->n[k] = __builtin_shufflevector(ab_n, cd_n, 0, 1, 8, 9, 4, 5, 12, 13);
}

static inline __attribute__((always_inline)) void light_lanes_load(const struct light_triangle t[LANES], struct light_lanes *out)
{
    light_lanes_corner(t, 0, out);
    light_lanes_corner(t, 1, out);
    light_lanes_corner(t, 2, out);
}
