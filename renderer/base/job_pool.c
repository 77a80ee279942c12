#include "base/job_pool.h"

#include <assert.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"

/* One job_pool_for() call. Lives on its caller's stack and stays listed until every worker has left it. */
struct loop {
    void (*run)(void *context, size_t index, unsigned worker);
    void *context;
    size_t count;
    atomic_size_t next;
    unsigned inside;  /* workers in this loop; guarded by the pool's mutex */
    unsigned entered; /* worker numbers handed out; guarded likewise */
    struct loop *link;
};

struct job_pool {
    pthread_mutex_t mutex;
    pthread_cond_t work, left;
    struct loop *loops;
    bool stopping;
    unsigned thread_count; /* started threads: one less than the pool's size */
    pthread_t threads[];
};

static void run_some(struct loop *loop, unsigned worker)
{
    for (size_t i; (i = atomic_fetch_add(&loop->next, 1)) < loop->count;)
        loop->run(loop->context, i, worker);
}

static struct loop *find_loop(struct job_pool *pool)
{
    for (struct loop *loop = pool->loops; loop; loop = loop->link)
        if (atomic_load(&loop->next) < loop->count && loop->entered <= pool->thread_count)
            return loop;
    return NULL;
}

static void *worker_main(void *argument)
{
    struct job_pool *pool = argument;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        struct loop *loop;
        while (!(loop = find_loop(pool)) && !pool->stopping)
            pthread_cond_wait(&pool->work, &pool->mutex);
        if (!loop)
            break;
        unsigned worker = loop->entered++;
        loop->inside++;
        pthread_mutex_unlock(&pool->mutex);
        run_some(loop, worker);
        pthread_mutex_lock(&pool->mutex);
        if (--loop->inside == 0)
            pthread_cond_broadcast(&pool->left);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

struct job_pool *job_pool_create(unsigned threads, struct error *err)
{
    assert(threads >= 1 && threads <= 256);
    struct job_pool *pool = calloc(1, sizeof *pool + (threads - 1) * sizeof pool->threads[0]);
    if (!pool) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for worker threads");
        return NULL;
    }
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->work, NULL);
    pthread_cond_init(&pool->left, NULL);
    for (; pool->thread_count < threads - 1; pool->thread_count++) {
        int failure = pthread_create(&pool->threads[pool->thread_count], NULL, worker_main, pool);
        if (failure) {
            error_set(err, ERROR_TRY_AGAIN, NULL, "cannot start worker thread %u: %s", pool->thread_count + 1, strerror(failure));
            job_pool_destroy(pool);
            return NULL;
        }
    }
    return pool;
}

void job_pool_destroy(struct job_pool *pool)
{
    if (!pool)
        return;
    pthread_mutex_lock(&pool->mutex);
    assert(!pool->loops);
    pool->stopping = true;
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->mutex);
    for (unsigned i = 0; i < pool->thread_count; i++)
        pthread_join(pool->threads[i], NULL);
    pthread_cond_destroy(&pool->left);
    pthread_cond_destroy(&pool->work);
    pthread_mutex_destroy(&pool->mutex);
    free(pool);
}

unsigned job_pool_threads(const struct job_pool *pool) { return pool->thread_count + 1; }

void job_pool_for(struct job_pool *pool, size_t count, void (*run)(void *context, size_t index, unsigned worker), void *context)
{
    if (count == 0)
        return;
    if (pool->thread_count == 0 || count == 1) {
        for (size_t i = 0; i < count; i++)
            run(context, i, 0);
        return;
    }
    struct loop loop = {.run = run, .context = context, .count = count, .entered = 1};
    pthread_mutex_lock(&pool->mutex);
    loop.link = pool->loops;
    pool->loops = &loop;
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->mutex);

    run_some(&loop, 0);

    pthread_mutex_lock(&pool->mutex);
    while (loop.inside > 0)
        pthread_cond_wait(&pool->left, &pool->mutex);
    struct loop **at = &pool->loops;
    while (*at != &loop)
        at = &(*at)->link;
    *at = loop.link;
    pthread_mutex_unlock(&pool->mutex);
}
