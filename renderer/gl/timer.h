/* Times of the passes of a frame: by GPU time stamps that are read when they have come in, never waited for; or, when asked, by
 * finishing after each pass, which is true on any device and slow. */
#pragma once

#include <stdbool.h>

#define GL_TIMER_PASSES 8
#define GL_TIMER_FRAMES 4

struct gl_timer {
    unsigned queries[GL_TIMER_FRAMES][GL_TIMER_PASSES + 1];
    bool used[GL_TIMER_FRAMES][GL_TIMER_PASSES + 1]; /* stamp 0 = the frame's start, stamp i + 1 = end of pass i */
    unsigned frame;
    double start_ms; /* finish mode: wall clock at the last mark */
    bool finish;
};

void gl_timer_init(struct gl_timer *t);
void gl_timer_finish(struct gl_timer *t);

/* A new frame. `finish`: glFinish after each pass and take wall times. */
void gl_timer_begin(struct gl_timer *t, bool finish);
/* Pass `pass` ends here. Returns its wall time in finish mode, else 0. Passes are marked in ascending order, each at most once. */
double gl_timer_mark(struct gl_timer *t, unsigned pass);
/* Pass times of the frame `age` frames back (0 = the current), in ms, 0 where not known yet. Does not wait. */
void gl_timer_read(struct gl_timer *t, unsigned age, double *pass_ms, unsigned pass_count);

/* Monotonic wall clock in ms. */
double clock_ms(void);
