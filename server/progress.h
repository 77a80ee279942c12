/* A bar on a terminal for work that takes over a second: on standard error, gone when the work is done, nothing where standard error
 * is not a terminal. Work that cannot say how far it is shows the seconds it has taken. */
#pragma once

#include <pthread.h>
#include <stdbool.h>

struct progress {
    const char *what; /* borrowed */
    bool enabled;     /* a thread draws; what follows is guarded by the mutex */
    bool finished;
    bool drawn;
    double done;    /* < 0: not known */
    double started; /* seconds, monotonic */
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
};

/* The struct must stay where it is until progress_finish(). */
void progress_init(struct progress *p, const char *what, bool quiet);
/* `done` in [0, 1]. From any thread; cheap enough to be called often. */
void progress_set(struct progress *p, double done);
/* Takes the bar away. */
void progress_finish(struct progress *p);
