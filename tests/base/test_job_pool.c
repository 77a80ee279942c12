#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"

static struct job_pool *make_pool(unsigned threads)
{
    struct error err = {0};
    struct job_pool *pool = job_pool_create(threads, &err);
    assert_non_null(pool);
    assert_int_equal(job_pool_threads(pool), threads);
    return pool;
}

struct visits {
    atomic_uint *seen;
    atomic_uint busy[64]; /* by worker: calls inside at this moment */
    atomic_uint faults;
    unsigned workers;
};

static void visit(void *context, size_t index, unsigned worker)
{
    struct visits *v = context;
    if (worker >= v->workers || atomic_fetch_add(&v->busy[worker], 1) != 0)
        atomic_fetch_add(&v->faults, 1);
    atomic_fetch_add(&v->seen[index], 1);
    if (worker < v->workers)
        atomic_fetch_sub(&v->busy[worker], 1);
}

/* Every index once, no worker number twice at a time. Returns faults found. */
static size_t run_loop(struct job_pool *pool, size_t count)
{
    struct visits v = {.seen = calloc(count + 1, sizeof *v.seen), .workers = job_pool_threads(pool)};
    job_pool_for(pool, count, visit, &v);
    size_t faults = atomic_load(&v.faults);
    for (size_t i = 0; i < count; i++)
        faults += atomic_load(&v.seen[i]) != 1;
    free(v.seen);
    return faults;
}

static void every_index_once(void **state)
{
    (void)state;
    static const size_t counts[] = {0, 1, 2, 3, 17, 1000, 100000};
    for (unsigned threads = 1; threads <= 5; threads++) {
        struct job_pool *pool = make_pool(threads);
        for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
            assert_int_equal(run_loop(pool, counts[i]), 0);
        job_pool_destroy(pool);
    }
}

static void note_thread(void *context, size_t index, unsigned worker)
{
    pthread_t *threads = context;
    assert_int_equal(worker, 0);
    threads[index] = pthread_self();
}

static void pool_of_one_stays_on_the_caller(void **state)
{
    (void)state;
    struct job_pool *pool = make_pool(1);
    pthread_t threads[50];
    job_pool_for(pool, 50, note_thread, threads);
    for (int i = 0; i < 50; i++)
        assert_true(pthread_equal(threads[i], pthread_self()));
    job_pool_destroy(pool);
}

/* Two indices that each wait for the other end only if two threads really run at once. */
static void meet(void *context, size_t index, unsigned worker)
{
    (void)index, (void)worker;
    pthread_barrier_wait(context);
}

static void work_is_shared(void **state)
{
    (void)state;
    struct job_pool *pool = make_pool(2);
    pthread_barrier_t barrier;
    pthread_barrier_init(&barrier, NULL, 2);
    job_pool_for(pool, 2, meet, &barrier);
    pthread_barrier_destroy(&barrier);
    job_pool_destroy(pool);
}

/* Plain memory: what `run` wrote must be seen by the caller, and what the caller wrote by `run` (a data race for TSan otherwise). */
static void square(void *context, size_t index, unsigned worker)
{
    (void)worker;
    uint64_t *values = context;
    values[index] *= values[index];
}

static void results_are_visible(void **state)
{
    (void)state;
    struct job_pool *pool = make_pool(4);
    uint64_t values[1000];
    for (uint64_t round = 0; round < 50; round++) {
        for (uint64_t i = 0; i < 1000; i++)
            values[i] = i + round;
        job_pool_for(pool, 1000, square, values);
        for (uint64_t i = 0; i < 1000; i++)
            assert_true(values[i] == (i + round) * (i + round));
    }
    job_pool_destroy(pool);
}

struct contender {
    struct job_pool *pool;
    size_t faults;
};

static void *contend(void *argument)
{
    struct contender *c = argument;
    for (size_t round = 0; round < 300; round++)
        c->faults += run_loop(c->pool, 1 + round % 40);
    return NULL;
}

/* More callers than workers, short loops: loops come and go in the pool's list all the time. */
static void several_callers_at_once(void **state)
{
    (void)state;
    struct job_pool *pool = make_pool(3);
    pthread_t threads[6];
    struct contender contenders[6];
    for (int i = 0; i < 6; i++) {
        contenders[i] = (struct contender){.pool = pool};
        assert_int_equal(pthread_create(&threads[i], NULL, contend, &contenders[i]), 0);
    }
    for (int i = 0; i < 6; i++) {
        pthread_join(threads[i], NULL);
        assert_int_equal(contenders[i].faults, 0);
    }
    job_pool_destroy(pool);
}

static void pools_come_and_go(void **state)
{
    (void)state;
    for (int i = 0; i < 100; i++) {
        struct job_pool *pool = make_pool(1 + (unsigned)i % 4);
        if (i % 2)
            assert_int_equal(run_loop(pool, 10), 0);
        job_pool_destroy(pool);
    }
    job_pool_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_index_once),        cmocka_unit_test(pool_of_one_stays_on_the_caller),
        cmocka_unit_test(work_is_shared),          cmocka_unit_test(results_are_visible),
        cmocka_unit_test(several_callers_at_once), cmocka_unit_test(pools_come_and_go),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
