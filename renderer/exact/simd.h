/* As many floats at once as the instruction set has that the file is compiled for; comparisons give a bit a lane. */
#pragma once

#include <stdint.h>

#include "exact/lines.h"

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#include <immintrin.h>
enum { WIDTH = 16 };
typedef __m512 wide;
static inline wide wide_all(float x) { return _mm512_set1_ps(x); }
static inline wide wide_load(const float *p) { return _mm512_loadu_ps(p); }
static inline wide wide_add(wide a, wide b) { return _mm512_add_ps(a, b); }
static inline wide wide_sub(wide a, wide b) { return _mm512_sub_ps(a, b); }
static inline wide wide_mul(wide a, wide b) { return _mm512_mul_ps(a, b); }
static inline wide wide_min(wide a, wide b) { return _mm512_min_ps(a, b); }
static inline float wide_least(wide a) { return _mm512_reduce_min_ps(a); }
static inline unsigned wide_above(wide a, wide b) { return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ); }
static inline unsigned wide_same(const uint32_t *p, uint32_t x)
{
    return _mm512_cmpeq_epi32_mask(_mm512_loadu_si512(p), _mm512_set1_epi32((int)x));
}
static inline void wide_put(float *p, wide x, unsigned lanes) { _mm512_mask_storeu_ps(p, (__mmask16)lanes, x); }
static inline void wide_put_id(uint32_t *p, uint32_t x, unsigned lanes)
{
    _mm512_mask_storeu_epi32(p, (__mmask16)lanes, _mm512_set1_epi32((int)x));
}
#elif defined(__AVX2__)
#include <immintrin.h>
enum { WIDTH = 8 };
typedef __m256 wide;
static inline wide wide_all(float x) { return _mm256_set1_ps(x); }
static inline wide wide_load(const float *p) { return _mm256_loadu_ps(p); }
static inline wide wide_add(wide a, wide b) { return _mm256_add_ps(a, b); }
static inline wide wide_sub(wide a, wide b) { return _mm256_sub_ps(a, b); }
static inline wide wide_mul(wide a, wide b) { return _mm256_mul_ps(a, b); }
static inline wide wide_min(wide a, wide b) { return _mm256_min_ps(a, b); }
static inline float wide_least(wide a)
{
    __m128 x = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    x = _mm_min_ps(x, _mm_movehl_ps(x, x));
    return _mm_cvtss_f32(_mm_min_ss(x, _mm_movehdup_ps(x)));
}
static inline unsigned wide_above(wide a, wide b) { return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_GT_OQ)); }
static inline unsigned wide_same(const uint32_t *p, uint32_t x)
{
    __m256i same = _mm256_cmpeq_epi32(_mm256_loadu_si256((const __m256i *)p), _mm256_set1_epi32((int)x));
    return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(same));
}
static inline __m256i wide_mask(unsigned lanes)
{
    const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    return _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)lanes), bit), bit);
}
static inline void wide_put(float *p, wide x, unsigned lanes) { _mm256_maskstore_ps(p, wide_mask(lanes), x); }
static inline void wide_put_id(uint32_t *p, uint32_t x, unsigned lanes)
{
    _mm256_maskstore_epi32((int *)p, wide_mask(lanes), _mm256_set1_epi32((int)x));
}
#else
enum { WIDTH = 1 };
typedef float wide;
static inline wide wide_all(float x) { return x; }
static inline wide wide_load(const float *p) { return *p; }
static inline wide wide_add(wide a, wide b) { return a + b; }
static inline wide wide_sub(wide a, wide b) { return a - b; }
static inline wide wide_mul(wide a, wide b) { return a * b; }
static inline wide wide_min(wide a, wide b) { return a < b ? a : b; }
static inline float wide_least(wide a) { return a; }
static inline unsigned wide_above(wide a, wide b) { return a > b; }
static inline unsigned wide_same(const uint32_t *p, uint32_t x) { return *p == x; }
static inline void wide_put(float *p, wide x, unsigned lanes)
{
    if (lanes)
        *p = x;
}
static inline void wide_put_id(uint32_t *p, uint32_t x, unsigned lanes)
{
    if (lanes)
        *p = x;
}
#endif

static inline wide wide_abs(wide a)
{
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    return _mm512_andnot_ps(_mm512_set1_ps(-0.0f), a);
#elif defined(__AVX2__)
    return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a);
#else
    return a < 0 ? -a : a;
#endif
}

/* Bit a lane where a > b. */
static inline __attribute__((always_inline)) unsigned lanes_above(const lane4 *a, const lane4 *b)
{
#ifdef __AVX2__
    return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd((__m256d)*a, (__m256d)*b, _CMP_GT_OQ));
#else
    return (unsigned)((*a)[0] > (*b)[0]) | (unsigned)((*a)[1] > (*b)[1]) << 1 | (unsigned)((*a)[2] > (*b)[2]) << 2 |
           (unsigned)((*a)[3] > (*b)[3]) << 3;
#endif
}

static inline __attribute__((always_inline)) lane4 lanes_max(lane4 a, lane4 b)
{
#ifdef __AVX2__
    return (lane4)_mm256_max_pd((__m256d)a, (__m256d)b);
#else
    lane4_bits above = (lane4_bits)(a > b);
    return (lane4)(((lane4_bits)a & above) | ((lane4_bits)b & ~above));
#endif
}
