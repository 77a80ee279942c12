/* Blocks of a tile: four columns of as many rows as the instruction set has numbers in a vector for, so that a long thin triangle fills more of
 * each than of a row. The same arithmetic in all, so the same bits. Included by the tile's kernels only. */
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "shadow/geometry/map_tile.h"

/* Vectors of this size are passed to inlined functions only. */
#pragma GCC diagnostic ignored "-Wpsabi"

#define INLINE static inline __attribute__((always_inline))

#if defined(__AVX512F__)
enum { BLOCK = 16 }; /* texels */
#elif defined(__AVX2__)
enum { BLOCK = 8 };
#else
enum { BLOCK = 4 };
#endif

enum { BLOCK_COLUMNS = 4, BLOCK_ROWS = BLOCK / BLOCK_COLUMNS, TEXELS = MAP_TILE * MAP_TILE, BLOCKS = TEXELS / BLOCK };

_Static_assert(MAP_TILE == 8 * BLOCK_COLUMNS, "a row of blocks is a byte of them");

typedef float block_float __attribute__((vector_size(4 * BLOCK)));
typedef int32_t block_int __attribute__((vector_size(4 * BLOCK)));
typedef uint32_t block_uint __attribute__((vector_size(4 * BLOCK)));

/* A difference, since 0 + -0 is not -0. */
INLINE block_float block_all(float value) { return value - (block_float){}; }

/* Where each texel of a block lies from its first. */
INLINE block_float block_columns(void)
{
    static const float columns[16] __attribute__((aligned(64))) = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    return *(const block_float *)columns;
}

INLINE block_float block_rows(void)
{
    static const float rows[16] __attribute__((aligned(64))) = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    return *(const block_float *)rows;
}

/* Texel (x, y)'s place among a tile's blocks, which lie row by row. */
INLINE uint32_t block_place(uint32_t x, uint32_t y)
{
    uint32_t block = y / BLOCK_ROWS * 8 + x / BLOCK_COLUMNS;
    return block * BLOCK + y % BLOCK_ROWS * BLOCK_COLUMNS + x % BLOCK_COLUMNS;
}

/* block_max() and block_min() give b where either is not a number. */
#if defined(__AVX512F__)

typedef __mmask16 block_mask;
INLINE block_mask block_at_least(block_float a, block_float b) { return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_GE_OQ); }
INLINE block_mask block_above(block_float a, block_float b) { return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_GT_OQ); }
INLINE block_float block_pick(block_mask m, block_float a, block_float b)
{
    return (block_float)_mm512_mask_blend_ps(m, (__m512)b, (__m512)a);
}
INLINE block_float block_max(block_float a, block_float b) { return (block_float)_mm512_max_ps((__m512)a, (__m512)b); }
INLINE block_float block_min(block_float a, block_float b) { return (block_float)_mm512_min_ps((__m512)a, (__m512)b); }
INLINE unsigned block_bits(block_mask m) { return m; }
INLINE block_mask block_of_bits(unsigned bits) { return (block_mask)bits; }

#else

typedef block_int block_mask;
INLINE block_mask block_at_least(block_float a, block_float b) { return a >= b; }
INLINE block_mask block_above(block_float a, block_float b) { return a > b; }
INLINE block_mask block_of_bits(unsigned bits)
{
    static const int32_t powers[8] __attribute__((aligned(32))) = {1, 2, 4, 8, 16, 32, 64, 128};
    return (*(const block_int *)powers & (int32_t)bits) != 0;
}

#ifdef __AVX2__

INLINE block_float block_pick(block_mask m, block_float a, block_float b)
{
    return (block_float)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)m);
}
INLINE block_float block_max(block_float a, block_float b) { return (block_float)_mm256_max_ps((__m256)a, (__m256)b); }
INLINE block_float block_min(block_float a, block_float b) { return (block_float)_mm256_min_ps((__m256)a, (__m256)b); }
INLINE unsigned block_bits(block_mask m) { return (unsigned)_mm256_movemask_ps((__m256)m); }

#else

INLINE block_float block_pick(block_mask m, block_float a, block_float b)
{
    return (block_float)((m & (block_int)a) | (~m & (block_int)b));
}
INLINE block_float block_max(block_float a, block_float b) { return block_pick(a > b, a, b); }
INLINE block_float block_min(block_float a, block_float b) { return block_pick(a < b, a, b); }
INLINE unsigned block_bits(block_mask m) { return (unsigned)((m[0] & 1) | (m[1] & 2) | (m[2] & 4) | (m[3] & 8)); }

#endif
#endif
