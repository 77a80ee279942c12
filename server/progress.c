#include "progress.h"

#include <math.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

static const double SHOW_AFTER_S = 1.0; /* shorter work shows nothing */
static const double REDRAW_S = 0.2;
static const double LEFT_AFTER_S = 10; /* shorter work need not say how long it will take ... */
static const double LEFT_FROM = 0.02;  /* ... and nobody knows before that much is done */
enum { BAR_WIDTH = 40 };

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ", about 3 min left" where that can be told. */
static void describe_left(const struct progress *p, char *out, size_t size)
{
    double taken = now() - p->started, left = taken / fmax(p->done, LEFT_FROM) * (1 - p->done);
    out[0] = 0;
    if (taken < LEFT_AFTER_S || p->done < LEFT_FROM)
        return;
    if (left < 90)
        snprintf(out, size, ", about %.0f s left", ceil(left));
    else
        snprintf(out, size, ", about %.0f min left", ceil(left / 60));
}

static void draw(const struct progress *p)
{
    char bar[BAR_WIDTH + 1];
    if (p->done < 0) {
        fprintf(stderr, "\r%s ... %.0f s\033[K", p->what, floor(now() - p->started));
    } else {
        for (int i = 0; i < BAR_WIDTH; i++)
            bar[i] = i < (int)(p->done * BAR_WIDTH + 0.5) ? '=' : ' ';
        bar[BAR_WIDTH] = 0;
        char left[40];
        describe_left(p, left, sizeof left);
        fprintf(stderr, "\r%s [%s] %3.0f %%%s\033[K", p->what, bar, floor(p->done * 100), left);
    }
    fflush(stderr);
}

static struct timespec at(double seconds)
{
    return (struct timespec){.tv_sec = (time_t)seconds, .tv_nsec = (long)((seconds - floor(seconds)) * 1e9)};
}

static void *redraw(void *context)
{
    struct progress *p = context;
    double next = p->started + SHOW_AFTER_S;
    pthread_mutex_lock(&p->mutex);
    while (!p->finished) {
        struct timespec wake = at(next);
        pthread_cond_timedwait(&p->changed, &p->mutex, &wake);
        if (p->finished || now() < next)
            continue;
        draw(p);
        p->drawn = true;
        next = now() + REDRAW_S;
    }
    pthread_mutex_unlock(&p->mutex);
    return NULL;
}

void progress_init(struct progress *p, const char *what, bool quiet)
{
    pthread_condattr_t monotonic;
    *p = (struct progress){.what = what, .done = -1, .started = now()};
    if (quiet || !isatty(STDERR_FILENO))
        return;
    pthread_mutex_init(&p->mutex, NULL);
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_cond_init(&p->changed, &monotonic);
    pthread_condattr_destroy(&monotonic);
    p->enabled = pthread_create(&p->thread, NULL, redraw, p) == 0;
}

void progress_set(struct progress *p, double done)
{
    if (!p->enabled)
        return;
    pthread_mutex_lock(&p->mutex);
    p->done = fmin(fmax(done, 0), 1);
    pthread_mutex_unlock(&p->mutex);
}

void progress_finish(struct progress *p)
{
    if (!p->enabled)
        return;
    pthread_mutex_lock(&p->mutex);
    p->finished = true;
    pthread_cond_signal(&p->changed);
    pthread_mutex_unlock(&p->mutex);
    pthread_join(p->thread, NULL);
    if (p->drawn) {
        fputs("\r\033[K", stderr);
        fflush(stderr);
    }
    pthread_cond_destroy(&p->changed);
    pthread_mutex_destroy(&p->mutex);
    p->enabled = false;
}
