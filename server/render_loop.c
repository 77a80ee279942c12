#include "render_loop.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "render_loop_state.h"
#include "scene_store.h"

/* How often to ask whether the GPU is done while there is nothing else to do. */
#define POLL_US 500

static void destroy_scenes(struct scene_entry *scenes)
{
    for (struct scene_entry *next; scenes; scenes = next) {
        next = scenes->link;
        render_scene_destroy(scenes->gpu);
        scenes->gpu = NULL;
        scene_entry_destroy(scenes);
    }
}

/* Locked. Sleeps until something changes after `seen`, or until clock_us() is `until_us`. */
static void wait_change(struct render_loop *loop, uint64_t seen, uint64_t until_us)
{
    struct timespec until = {.tv_sec = (time_t)(until_us / 1000000), .tv_nsec = (long)(until_us % 1000000) * 1000};
    while (loop->events == seen && !loop->stopping) {
        if (until_us == UINT64_MAX)
            pthread_cond_wait(&loop->changed, &loop->mutex);
        else if (pthread_cond_timedwait(&loop->changed, &loop->mutex, &until) == ETIMEDOUT)
            break;
    }
}

/* One round: frees what is retired, collects what is done, submits what is wanted, sleeps when there was nothing to do. False to stop. */
static bool turn(struct render_loop *loop)
{
    struct picked picked;
    uint64_t due = UINT64_MAX;
    bool collected = render_flight_collect(loop, false);
    pthread_mutex_lock(&loop->mutex);
    uint64_t seen = loop->events;
    struct scene_entry *retired = loop->retired;
    loop->retired = NULL;
    pthread_mutex_unlock(&loop->mutex);
    destroy_scenes(retired);
    render_compare_finish(loop, false);

    bool room = render_flight_has_room(loop);
    pthread_mutex_lock(&loop->mutex);
    bool stopping = loop->stopping;
    bool may_compare = !stopping && !loop->failed && !loop->comparing;
    struct encode_job *compare = may_compare ? render_pick_request(&loop->compares, &loop->compare_count) : NULL;
    bool found = !stopping && room && render_pick(loop, &picked, &due);
    if (!found && !collected && !stopping && !compare) {
        uint64_t poll = clock_us() + POLL_US;
        wait_change(loop, seen, loop->in_flight_count > 0 && !loop->failed && poll < due ? poll : due);
    }
    pthread_mutex_unlock(&loop->mutex);
    if (found)
        render_flight_submit(loop, &picked);
    if (compare)
        render_compare_run(loop, compare);
    return !stopping;
}

/* Requests that will not be rendered any more go back with a reason. */
static void refuse_requests(struct render_loop *loop)
{
    struct error err = {0};
    struct encode_job *job;
    error_set(&err, ERROR_TRY_AGAIN, NULL, "the server is shutting down");
    do {
        pthread_mutex_lock(&loop->mutex);
        if (!(job = render_pick_request(&loop->snapshots, &loop->snapshot_count)))
            job = render_pick_request(&loop->compares, &loop->compare_count);
        pthread_mutex_unlock(&loop->mutex);
        if (job)
            render_flight_fail(loop, job, &err);
    } while (job);
}

static bool start(struct render_loop *loop)
{
    loop->renderer = renderer_create(&loop->options.renderer, loop->options.pool, &loop->start_error);
    if (loop->renderer)
        loop->device = *renderer_device(loop->renderer);
    pthread_mutex_lock(&loop->mutex);
    loop->started = true;
    pthread_cond_broadcast(&loop->changed);
    pthread_mutex_unlock(&loop->mutex);
    return loop->renderer;
}

static void *render_main(void *argument)
{
    struct render_loop *loop = argument;
    if (!start(loop))
        return NULL;
    while (turn(loop))
        ;
    render_compare_finish(loop, true);
    refuse_requests(loop);
    while (loop->in_flight_count > 0 && render_flight_collect(loop, true))
        ;
    while (loop->in_flight_count > 0)
        render_flight_drop(loop);
    destroy_scenes(loop->retired);
    loop->retired = NULL;
    for (struct scene_entry *scene = loop->remaining; scene; scene = scene->link) {
        render_scene_destroy(scene->gpu);
        scene->gpu = NULL;
    }
    renderer_destroy(loop->renderer);
    return NULL;
}

struct render_loop *render_loop_create(const struct render_loop_options *options, struct error *err)
{
    struct render_loop *loop = calloc(1, sizeof *loop);
    if (!loop) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the render thread");
        return NULL;
    }
    loop->options = *options;
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&loop->changed, &attributes);
    pthread_condattr_destroy(&attributes);
    pthread_mutex_init(&loop->mutex, NULL);
    int failure = pthread_create(&loop->thread, NULL, render_main, loop);
    if (failure) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "cannot start the render thread: %s", strerror(failure));
        goto free_loop;
    }
    pthread_mutex_lock(&loop->mutex);
    while (!loop->started)
        pthread_cond_wait(&loop->changed, &loop->mutex);
    pthread_mutex_unlock(&loop->mutex);
    if (loop->start_error.code == ERROR_NONE)
        return loop;
    pthread_join(loop->thread, NULL);
    *err = loop->start_error;
free_loop:
    pthread_cond_destroy(&loop->changed);
    pthread_mutex_destroy(&loop->mutex);
    free(loop);
    return NULL;
}

void render_loop_stop(struct render_loop *loop, struct scene_entry *scenes)
{
    pthread_mutex_lock(&loop->mutex);
    loop->stopping = true;
    loop->remaining = scenes;
    render_loop_changed(loop);
    pthread_mutex_unlock(&loop->mutex);
    pthread_join(loop->thread, NULL);
}

void render_loop_destroy(struct render_loop *loop)
{
    if (!loop)
        return;
    pthread_cond_destroy(&loop->changed);
    pthread_mutex_destroy(&loop->mutex);
    free(loop);
}

const struct device_info *render_loop_device(const struct render_loop *loop) { return &loop->device; }
