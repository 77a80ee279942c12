#include "progress.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

static const double SHOW_AFTER_S = 1.0; /* shorter work shows nothing */
static const double REDRAW_S = 0.1;
enum { BAR_WIDTH = 40 };

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress_init(struct progress *p, const char *what, bool quiet)
{
    *p = (struct progress){.what = what, .enabled = !quiet && isatty(STDERR_FILENO), .started = now()};
    pthread_mutex_init(&p->mutex, NULL);
}

static void draw(const struct progress *p, double done)
{
    char bar[BAR_WIDTH + 1];
    for (int i = 0; i < BAR_WIDTH; i++)
        bar[i] = i < (int)(done * BAR_WIDTH + 0.5) ? '=' : ' ';
    bar[BAR_WIDTH] = 0;
    fprintf(stderr, "\r%s [%s] %3d %%\033[K", p->what, bar, (int)(done * 100 + 0.5));
    fflush(stderr);
}

void progress_set(struct progress *p, double done)
{
    if (!p->enabled)
        return;
    done = done < 0 ? 0 : done > 1 ? 1 : done;
    pthread_mutex_lock(&p->mutex);
    double t = now();
    if (t - p->started > SHOW_AFTER_S && t - p->last > REDRAW_S) {
        p->last = t;
        p->drawn = true;
        draw(p, done);
    }
    pthread_mutex_unlock(&p->mutex);
}

void progress_finish(struct progress *p)
{
    if (p->drawn) {
        fputs("\r\033[K", stderr);
        fflush(stderr);
    }
    pthread_mutex_destroy(&p->mutex);
}

bool progress_report(void *progress, double done)
{
    progress_set(progress, done);
    return true;
}
