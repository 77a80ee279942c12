/* How much a shadow jumps from frame to frame while light or camera move slowly: the mean of |V(t+1) - 2 V(t) + V(t-1)| over the pixels that
 * are receivers in all three frames, and over time. Even change has none; a pixel that goes dark for one frame counts 4 (twice 1, once 2). A
 * perfect picture has some too, where an edge passes: what counts is the excess over the reference's own. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Of one light. Memory is owned: flicker_finish(). */
struct flicker {
    size_t pixels;
    float *tested[3], *truth[3]; /* the last frames; frame n lies at n % 3 */
    uint8_t *receiver[3];
    unsigned frames;
    uint64_t count; /* pixels times triples of frames */
    double tested_sum, truth_sum;
};

/* False when memory is out; flicker_finish() is to be called all the same. */
bool flicker_init(struct flicker *f, size_t pixels);
void flicker_finish(struct flicker *f);

/* The next frame; all three are copied. */
void flicker_add(struct flicker *f, const float *tested, const float *truth, const uint8_t *receiver);
