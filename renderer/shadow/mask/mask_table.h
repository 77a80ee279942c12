/* The shadow-mask table: which of a pixel's 32 samples (view_samples32) lie on one side of a line through it.
 *
 * The patent text indexes by slope and intercept, which cannot hold upright lines: here by the direction and the distance of the line
 * c + x X + y Y = 0, both in the sum norm, |x| + |y| = 1: there a line that meets the pixel has |c| < 1/2, and the direction is y and the sign
 * of x. Bit i of an entry: sample i lies where c + x X + y Y > 0, for the line in the middle of the entry's cell. */
#pragma once

#include <math.h>
#include <stdint.h>

enum { MASK_DIRECTIONS = 128, MASK_OFFSETS = 128 };

struct mask_table {
    uint32_t bits[2 * MASK_DIRECTIONS][MASK_OFFSETS];
    double wrong; /* part of the sample bits that it gets wrong, over lines that meet the pixel */
};

void mask_table_fill(struct mask_table *t);

/* Samples where c + x X + y Y > 0; X right, Y down, in pixels from the pixel's centre. */
static inline uint32_t mask_table_look(const struct mask_table *t, float c, float x, float y)
{
    float norm = fabsf(x) + fabsf(y);
    if (!(fabsf(c) < 0.5f * norm))
        return c > 0 ? UINT32_MAX : 0;
    float scale = 1 / norm;
    int direction = (int)((y * scale + 1) * (0.5f * MASK_DIRECTIONS)), offset = (int)((c * scale + 0.5f) * MASK_OFFSETS);
    direction = direction < MASK_DIRECTIONS ? direction : MASK_DIRECTIONS - 1;
    offset = offset < MASK_OFFSETS ? offset : MASK_OFFSETS - 1;
    return t->bits[direction + (x < 0 ? MASK_DIRECTIONS : 0)][offset];
}
