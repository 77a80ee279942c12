/* Eight projected triangles at a time, a vector lane each. For callers that compile twice, for AVX2 and for any machine: the same arithmetic in the
 * same order, so the same bits. */
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "shadow/conservative.h"
#include "shadow/light_mesh.h"

typedef float lanes_quarter __attribute__((vector_size(16)));
typedef int32_t lanes_int_loose __attribute__((vector_size(32), aligned(4), may_alias));
typedef int64_t lanes_long __attribute__((vector_size(32)));

/* Macros, since vectors that functions return depend on the instruction set. A mask's lanes are all ones or all zeros; LANES_MAX and LANES_MIN give b
 * where either is not a number. Files that are compiled for AVX2 say the same in its own words, which the compiler does not find by itself. */
#ifdef __AVX2__
#define LANES_IF(mask, a, b) ((lanes_float)_mm256_blendv_ps((__m256)(b), (__m256)(a), (__m256)(mask)))
#define LANES_MAX(a, b)      ((lanes_float)_mm256_max_ps((__m256)(a), (__m256)(b)))
#define LANES_MIN(a, b)      ((lanes_float)_mm256_min_ps((__m256)(a), (__m256)(b)))
#define LANES_BITS(mask)     ((unsigned)_mm256_movemask_ps((__m256)(mask)))
#define LANES_ANY(mask)      (LANES_BITS(mask) != 0)
#else
#define LANES_IF(mask, a, b) ((lanes_float)(((mask) & (lanes_int)(a)) | (~(mask) & (lanes_int)(b))))
#define LANES_MAX(a, b)      LANES_IF((a) > (b), a, b)
#define LANES_MIN(a, b)      LANES_IF((a) < (b), a, b)
#define LANES_BITS(mask)     light_lanes_halves(LANES_FOLD(((mask)&light_lanes_powers)))
#define LANES_ANY(mask)      (LANES_FOLD(mask) != 0)
#endif
#define LANES_ALL(value) ((lanes_float){} + (value))
#define LANES_ABS(v)     ((lanes_float)((lanes_int)(v) & ((lanes_int){} + INT32_MAX)))
#define LANES_FOLD(m)    (((lanes_long)(m))[0] | ((lanes_long)(m))[1] | ((lanes_long)(m))[2] | ((lanes_long)(m))[3])
/* The square root of each, correctly rounded whatever the instruction set. */
#define LANES_ROOT(v)                                         \
    do {                                                      \
        for (int lane = 0; lane < CONSERVATIVE_LANES; lane++) \
            (v)[lane] = __builtin_sqrtf((v)[lane]);           \
    } while (0)
#define LANES_OF(low, high) __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7)

#define LANES_LEAST(v) LANES_MIN(LANES_MIN((v)[0], (v)[1]), (v)[2])
#define LANES_MOST(v)  LANES_MAX(LANES_MAX((v)[0], (v)[1]), (v)[2])

static const lanes_int light_lanes_powers = {1, 2, 4, 8, 16, 32, 64, 128};
static inline unsigned light_lanes_halves(int64_t both) { return (unsigned)(both | both >> 32) & 0xff; }

/* Corner k's coordinates, of each lane. */
struct light_lanes {
    lanes_float x[3], y[3], n[3];
};

static inline __attribute__((always_inline)) void light_lanes_corner(const struct light_triangle t[CONSERVATIVE_LANES], int k,
                                                                     struct light_lanes *out)
{
    lanes_quarter v[CONSERVATIVE_LANES];
#pragma GCC unroll 8
    for (int i = 0; i < CONSERVATIVE_LANES; i++)
        v[i] = *(const lanes_quarter *)(const void *)t[i].corner[k];
    lanes_float a = LANES_OF(v[0], v[4]), b = LANES_OF(v[1], v[5]), c = LANES_OF(v[2], v[6]), d = LANES_OF(v[3], v[7]);
    lanes_float ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
    lanes_float cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
    lanes_float ab_n = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
    lanes_float cd_n = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
    out->x[k] = __builtin_shufflevector(ab, cd, 0, 1, 8, 9, 4, 5, 12, 13);
    out->y[k] = __builtin_shufflevector(ab, cd, 2, 3, 10, 11, 6, 7, 14, 15);
    out->n[k] = __builtin_shufflevector(ab_n, cd_n, 0, 1, 8, 9, 4, 5, 12, 13);
}

static inline __attribute__((always_inline)) void light_lanes_load(const struct light_triangle t[CONSERVATIVE_LANES],
                                                                   struct light_lanes *out)
{
    light_lanes_corner(t, 0, out);
    light_lanes_corner(t, 1, out);
    light_lanes_corner(t, 2, out);
}
