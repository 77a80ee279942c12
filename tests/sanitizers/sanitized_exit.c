/* Linked into every program of a sanitizer build: what a process needs to be looked at fairly when it ends. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* A GL driver is unloaded with its display; what it still holds then has no module and no names any more, so that lsan.supp and tsan.supp
 * could not tell it from ours. Here libraries stay. */
int dlclose(void *handle);

int dlclose(void *handle)
{
    (void)handle;
    return 0;
}

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>

static int count_threads(void)
{
    DIR *tasks = opendir("/proc/self/task");
    int count = 0;
    while (tasks && readdir(tasks))
        count++;
    if (tasks)
        closedir(tasks);
    return count;
}

/* LeakSanitizer reads the thread-local storage of every thread, and dies ("Tracer caught signal 11") when one ends under its hands. TBB, below
 * Embree, lets its workers end on their own: their number has to stand still before we look. A worker that stays is no trouble. */
static void check_leaks(void)
{
    const struct timespec pause = {.tv_nsec = 10 * 1000 * 1000};
    int count = count_threads();
    for (int still = 0, tries = 0; still < 3 && tries < 200; tries++) {
        nanosleep(&pause, NULL);
        int now = count_threads();
        still = now == count ? still + 1 : 0;
        count = now;
    }
    fflush(NULL);
    __lsan_do_leak_check();
}

/* Runs after the constructors of the libraries, so that the check comes before their destructors, which end threads too. */
__attribute__((constructor)) static void check_leaks_at_exit(void) { atexit(check_leaks); }
#endif
