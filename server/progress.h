/* A bar on a terminal for work that takes over a second: standard error, gone when the work is done, nothing where standard error is
 * not a terminal. */
#pragma once

#include <pthread.h>
#include <stdbool.h>

struct progress {
    const char *what; /* borrowed */
    bool enabled;
    bool drawn;
    double started, last; /* seconds, monotonic */
    pthread_mutex_t mutex;
};

void progress_init(struct progress *p, const char *what, bool quiet);
/* `done` in [0, 1]. From any thread; cheap enough to be called often. */
void progress_set(struct progress *p, double done);
/* Takes the bar away. */
void progress_finish(struct progress *p);
/* progress_set() in the shape of struct reference_progress: never asks to stop. */
bool progress_report(void *progress, double done);
