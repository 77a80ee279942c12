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
    unsigned converge_frames; /* before the timed ones, until another would have changed nothing; 0: were not waited for */
    struct frame_info last;
};

enum { UNTIMED_FRAMES = 3, FRAMES_TIMED_DEFAULT = 20 };

/* `moving` turns the lights by 0.25 degrees for each frame; still lights are timed once a progressive system has converged. Where timer queries do not add up to the frame (llvmpipe defers work),
 * pass times come from a second run with a finish after each pass. `progress` may be NULL. */
bool measure_frames(struct stage *stage, unsigned frames, bool moving, struct progress *progress, struct measurement *out,
                    struct error *err);

/* Gets each frame as it comes; `pixels` as stage_picture(). False stops. */
struct frame_sink {
    bool (*take)(void *context, unsigned frame, const struct frame_info *info, const void *pixels, struct error *err);
    void *context;
};

/* The first `frames` of a still view, each timed with a finish after each pass, none left out: how a progressive system gets there. */
bool measure_progress(struct stage *stage, unsigned frames, const struct frame_sink *sink, struct progress *progress,
                      struct measurement *out, struct error *err);

/* How many frames to time when nobody said: FRAMES_TIMED_DEFAULT, down to 3 where a frame takes over half a second. */
unsigned measure_default_frames(double frame_ms);

/* The p-th quantile, p in [0, 1], of `count` >= 1 values: the value at the nearest rank (0.5: the middle, of an even count the mean of
 * both). Sorts `values`. */
double quantile(double *values, size_t count, double p);
