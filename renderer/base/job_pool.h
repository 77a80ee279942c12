/* Worker threads for data-parallel loops. The renderer makes none of its own: whoever calls it passes a pool in. */
#pragma once

#include <stddef.h>

struct job_pool;
struct error;

/* `threads` counts the calling thread: a pool of one starts no thread and runs everything on the caller.
 * 1..256. NULL with `err` set when threads cannot be started. */
struct job_pool *job_pool_create(unsigned threads, struct error *err);

/* Accepts NULL. No loop may be running. */
void job_pool_destroy(struct job_pool *pool);

unsigned job_pool_threads(const struct job_pool *pool);

/* Calls run(context, index, worker) for every index in [0, count), in no fixed order, each once; returns when all are
 * done. The caller works too. `worker` is in [0, job_pool_threads) and never shared by two calls at the same time within
 * one loop. May be called from several threads at once; not from inside `run`. */
void job_pool_for(struct job_pool *pool, size_t count, void (*run)(void *context, size_t index, unsigned worker), void *context);
