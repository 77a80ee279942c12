/* Times of frames, one in flight, after three untimed ones. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "renderer.h"

struct progress;
struct stage;

struct measurement {
    unsigned frames;
    bool moving;
    double min_ms, median_ms, p95_ms; /* from the start of a frame to its pixels in CPU memory */
    double pass_ms[PASS_COUNT];       /* medians */
    size_t shadow_bytes;              /* after the last frame */
    size_t shadow_bytes_max;          /* over all frames */
    struct frame_info last;
};

enum { UNTIMED_FRAMES = 3, FRAMES_TIMED_DEFAULT = 20 };

/* `moving` turns the lights by 0.25 degrees for each frame. Where timer queries do not add up to the frame (llvmpipe defers work),
 * pass times come from a second run with a finish after each pass. `progress` may be NULL. */
bool measure_frames(struct stage *stage, unsigned frames, bool moving, struct progress *progress, struct measurement *out,
                    struct error *err);

/* How many frames to time when nobody said: FRAMES_TIMED_DEFAULT, down to 3 where a frame takes over half a second. */
unsigned measure_default_frames(double frame_ms);

/* The p-th quantile, p in [0, 1], of `count` >= 1 values: the value at the nearest rank (0.5: the middle, of an even count the mean of
 * both). Sorts `values`. */
double quantile(double *values, size_t count, double p);
