/* Ctrl-C as a question that can be asked between two frames. */
#pragma once

#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>

struct interruption {
    int fd; /* signalfd(2); -1: none, then the signals end the program as ever */
    atomic_bool came;
    sigset_t before;
};

/* Before any thread is made: they inherit the blocked SIGINT and SIGTERM. */
void interruption_init(struct interruption *i);
/* Any thread. */
bool interruption_came(struct interruption *i);
/* The thread of interruption_init(). */
void interruption_finish(struct interruption *i);
