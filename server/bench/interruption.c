#include "interruption.h"

#include <pthread.h>
#include <sys/signalfd.h>
#include <unistd.h>

void interruption_init(struct interruption *i)
{
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    atomic_init(&i->came, false);
    i->fd = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
    if (i->fd >= 0)
        pthread_sigmask(SIG_BLOCK, &signals, &i->before);
}

void interruption_finish(struct interruption *i)
{
    if (i->fd < 0)
        return;
    close(i->fd);
    i->fd = -1;
    pthread_sigmask(SIG_SETMASK, &i->before, NULL);
}

bool interruption_came(struct interruption *i)
{
    struct signalfd_siginfo info;
    if (i->fd >= 0 && read(i->fd, &info, sizeof info) > 0)
        atomic_store(&i->came, true);
    return atomic_load(&i->came);
}
