/* Eight numbers at once, in GCC's vectors: compiled for AVX2 and, in halves, for whatever the compiler knows without it, to the same bits:
 * every operation is rounded once. A mask holds -1 in a lane that is true, 0 elsewhere. */
#pragma once

#include <stdint.h>
#ifdef __AVX2__
#include <immintrin.h>
#else
#include <math.h>
#endif

/* Vectors of this size are passed to inlined functions only. */
#pragma GCC diagnostic ignored "-Wpsabi"

enum { LANES = 8 };
typedef float lanes __attribute__((vector_size(32)));
typedef int32_t lane_ints __attribute__((vector_size(32)));
typedef uint32_t lane_uints __attribute__((vector_size(32)));
typedef lanes lanes_anywhere __attribute__((aligned(4), may_alias));
typedef lane_ints lane_ints_anywhere __attribute__((aligned(4), may_alias));

#define LANES_COUNT ((lanes){0, 1, 2, 3, 4, 5, 6, 7})

#define LANES_INLINE static inline __attribute__((always_inline))

LANES_INLINE lanes lanes_all(float x) { return (lanes){x, x, x, x, x, x, x, x}; }
LANES_INLINE lane_ints lane_ints_all(int32_t x) { return (lane_ints){x, x, x, x, x, x, x, x}; }
LANES_INLINE lanes lanes_from(lane_ints a) { return __builtin_convertvector(a, lanes); }
/* Towards 0; |a| < 2^31. */
LANES_INLINE lane_ints lanes_truncate(lanes a) { return __builtin_convertvector(a, lane_ints); }
LANES_INLINE lanes lanes_load(const float *p) { return *(const lanes_anywhere *)p; }
LANES_INLINE void lanes_store(float *p, lanes a) { *(lanes_anywhere *)p = a; }
LANES_INLINE lane_ints lane_ints_load(const void *p) { return *(const lane_ints_anywhere *)p; }
LANES_INLINE void lane_ints_store(void *p, lane_ints a) { *(lane_ints_anywhere *)p = a; }
LANES_INLINE lanes lanes_if(lane_ints mask, lanes a) { return (lanes)((lane_ints)a & mask); }
LANES_INLINE lane_ints lane_ints_pick(lane_ints mask, lane_ints a, lane_ints b) { return (a & mask) | (b & ~mask); }
LANES_INLINE lanes lanes_abs(lanes a) { return (lanes)((lane_ints)a & lane_ints_all(INT32_MAX)); }

#ifdef __AVX2__

LANES_INLINE lanes lanes_pick(lane_ints mask, lanes a, lanes b) { return _mm256_blendv_ps(b, a, (__m256)mask); }
LANES_INLINE lanes lanes_min(lanes a, lanes b) { return _mm256_min_ps(a, b); }
LANES_INLINE lanes lanes_max(lanes a, lanes b) { return _mm256_max_ps(a, b); }
LANES_INLINE lanes lanes_sqrt(lanes a) { return _mm256_sqrt_ps(a); }
/* A bit a lane. */
LANES_INLINE unsigned lanes_bits(lane_ints mask) { return (unsigned)_mm256_movemask_ps((__m256)mask); }
LANES_INLINE lanes lanes_gather(const float *p, lane_ints at)
{
    return (lanes){p[at[0]], p[at[1]], p[at[2]], p[at[3]], p[at[4]], p[at[5]], p[at[6]], p[at[7]]};
}

/* out[i]: number 4 at + i. */
LANES_INLINE void lanes_gather_fours(const float *p, lane_ints at, lanes out[4])
{
    __m256 rows[4];
    for (int i = 0; i < 4; i++)
        rows[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p + 4 * (intptr_t)at[i])),
                                       _mm_loadu_ps(p + 4 * (intptr_t)at[i + 4]), 1);
    __m256 a = _mm256_unpacklo_ps(rows[0], rows[1]), b = _mm256_unpacklo_ps(rows[2], rows[3]);
    __m256 c = _mm256_unpackhi_ps(rows[0], rows[1]), d = _mm256_unpackhi_ps(rows[2], rows[3]);
    out[0] = _mm256_shuffle_ps(a, b, 0x44);
    out[1] = _mm256_shuffle_ps(a, b, 0xee);
    out[2] = _mm256_shuffle_ps(c, d, 0x44);
    out[3] = _mm256_shuffle_ps(c, d, 0xee);
}

#else

LANES_INLINE lanes lanes_pick(lane_ints mask, lanes a, lanes b)
{
    return (lanes)(((lane_ints)a & mask) | ((lane_ints)b & ~mask));
}
/* As the instructions of that name: b where either is not a number. */
LANES_INLINE lanes lanes_min(lanes a, lanes b) { return lanes_pick(a < b, a, b); }
LANES_INLINE lanes lanes_max(lanes a, lanes b) { return lanes_pick(a > b, a, b); }

LANES_INLINE lanes lanes_sqrt(lanes a)
{
    lanes out;
    for (int i = 0; i < LANES; i++)
        out[i] = sqrtf(a[i]);
    return out;
}

LANES_INLINE unsigned lanes_bits(lane_ints mask)
{
    typedef int64_t pairs __attribute__((vector_size(32)));
    pairs powers = (pairs)(mask & (lane_ints){1, 2, 4, 8, 16, 32, 64, 128});
    int64_t both = powers[0] | powers[1] | powers[2] | powers[3];
    return (unsigned)(both | both >> 32) & 0xff;
}

LANES_INLINE lanes lanes_gather(const float *p, lane_ints at)
{
    lanes out;
    for (int i = 0; i < LANES; i++)
        out[i] = p[at[i]];
    return out;
}

LANES_INLINE void lanes_gather_fours(const float *p, lane_ints at, lanes out[4])
{
    for (int i = 0; i < LANES; i++)
        for (int k = 0; k < 4; k++)
            out[k][i] = p[4 * (intptr_t)at[i] + k];
}

#endif

LANES_INLINE lane_ints lane_ints_gather(const void *p, lane_ints at) { return (lane_ints)lanes_gather(p, at); }
LANES_INLINE lane_ints lane_ints_min(lane_ints a, lane_ints b) { return lane_ints_pick(a < b, a, b); }
LANES_INLINE lane_ints lane_ints_max(lane_ints a, lane_ints b) { return lane_ints_pick(a > b, a, b); }

LANES_INLINE float larger(float a, float b) { return a > b ? a : b; }

LANES_INLINE float lanes_largest(lanes a)
{
    float m = a[0];
    for (int i = 1; i < LANES; i++)
        m = a[i] > m ? a[i] : m;
    return m;
}

LANES_INLINE float lanes_least(lanes a)
{
    float m = a[0];
    for (int i = 1; i < LANES; i++)
        m = a[i] < m ? a[i] : m;
    return m;
}

LANES_INLINE int32_t lane_ints_sum(lane_ints a) { return a[0] + a[1] + a[2] + a[3] + a[4] + a[5] + a[6] + a[7]; }

/* |a| < 2^31. */
LANES_INLINE lanes lanes_floor(lanes a)
{
    lanes whole = lanes_from(lanes_truncate(a));
    return whole - lanes_if(whole > a, lanes_all(1));
}
