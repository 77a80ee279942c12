#include <assert.h>
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "clock.h"
#include "compare_task.h"
#include "render_loop_state.h"
#include "scene_store.h"

/* How often to ask whether the GPU is done while there is nothing else to do. */
#define POLL_US        500
/* Pictures waiting for an encoder; past this, rendering more would only age them. */
#define ENCODE_BACKLOG 4

/* What the thread picked to render, copied out of the lock. */
struct picked {
    struct encode_job *job;
    struct scene_entry *scene; /* one reference */
    struct render_settings settings;
};

static size_t algorithm_index(const struct shadow_system *system)
{
    size_t i = 0;
    while (i < shadow_system_count && shadow_systems[i] != system)
        i++;
    return i;
}

/* Drops the job of a frame or snapshot that failed, telling the network thread why. */
static void fail_job(struct render_loop *loop, struct encode_job *job, const struct error *err)
{
    job->err = *err;
    atomic_fetch_add(&loop->options.metrics->dropped[DROP_FAILED], 1);
    encode_pool_fail(loop->options.encoders, job);
}

static struct encode_job *job_of_view(struct stream_view *view, bool still)
{
    struct encode_job *job = encode_job_create();
    if (!job)
        return NULL;
    const struct view_state *state = &view->wanted;
    job->session = view->session;
    job->quality = still && state->quality < STREAM_STILL_QUALITY ? STREAM_STILL_QUALITY : state->quality;
    job->header = (struct frame_header){
        .kind = GNMF_STREAM,
        .codec = state->codec,
        .flags = (uint16_t)(GNMF_KEY | (still ? GNMF_STILL : 0) | (state->codec == GNMF_PNG ? GNMF_LOSSLESS : 0)),
        .view = view->id,
        .input_time_us = state->input_time_us,
        .input_seq = state->input_seq,
    };
    job->header.frame = stream_view_submit(view, still, clock_us());
    return job;
}

/* Locked. The next view that needs a frame and may have one; *due_us falls to the earliest that only has to wait. */
static bool pick_view(struct render_loop *loop, struct picked *out, uint64_t *due_us)
{
    uint64_t now = clock_us();
    for (unsigned i = 0; i < RENDER_LOOP_VIEWS; i++) {
        unsigned index = (loop->turn + i) % RENDER_LOOP_VIEWS;
        struct stream_view *view = &loop->views[index];
        uint64_t due;
        if (view->id == 0)
            continue;
        enum stream_need need = stream_view_need(view, now, &due);
        if (need == STREAM_LATER && due < *due_us)
            *due_us = due;
        if (need != STREAM_FRAME && need != STREAM_STILL)
            continue;
        if (!(out->job = job_of_view(view, need == STREAM_STILL)))
            return false;
        out->scene = scene_entry_ref(view->scene);
        out->settings = view->wanted.settings;
        out->settings.viewer = view->id;
        loop->turn = index + 1;
        return true;
    }
    return false;
}

/* Locked. */
static struct encode_job *take_request(struct render_request **list, size_t *count)
{
    struct render_request *request = *list;
    struct encode_job *job = request ? encode_job_create() : NULL;
    if (!job)
        return NULL;
    *list = request->link;
    --*count;
    job->session = request->session;
    job->quality = request->quality;
    job->request = request;
    return job;
}

/* Locked. */
static bool pick_snapshot(struct render_loop *loop, struct picked *out)
{
    if (!(out->job = take_request(&loop->snapshots, &loop->snapshot_count)))
        return false;
    const struct render_request *snapshot = out->job->request;
    out->scene = scene_entry_ref(snapshot->scene);
    out->settings = snapshot->settings;
    out->job->header = (struct frame_header){
        .kind = GNMF_SNAPSHOT,
        .codec = snapshot->codec,
        .flags =
            (uint16_t)(GNMF_KEY | GNMF_STILL | (snapshot->codec == GNMF_PNG || snapshot->codec == GNMF_EXR ? GNMF_LOSSLESS : 0)),
        .request_id = snapshot->request_id,
    };
    return true;
}

/* Locked. */
static bool pick(struct render_loop *loop, struct picked *out, uint64_t *due_us)
{
    bool first = !loop->snapshot_last && pick_snapshot(loop, out);
    bool found = first || pick_view(loop, out, due_us) || pick_snapshot(loop, out);
    if (found)
        loop->snapshot_last = out->job->request;
    return found;
}

static bool request_is_late(const struct render_request *snapshot, struct error *err)
{
    if (atomic_load(&snapshot->cancelled))
        return !error_set(err, ERROR_TRY_AGAIN, NULL, "the request was cancelled");
    if (snapshot->deadline_us && clock_us() > snapshot->deadline_us)
        return !error_set(err, ERROR_TRY_AGAIN, "deadline_ms",
                          "deadline_ms: the deadline passed before this picture's turn came");
    return false;
}

static bool upload(struct render_loop *loop, struct scene_entry *scene, struct error *err)
{
    if (!scene->gpu)
        scene->gpu = render_scene_create(loop->renderer, scene->scene, err);
    return scene->gpu;
}

/* `picked->job` and its scene reference pass on, to the ring or to the failed. */
static void submit(struct render_loop *loop, const struct picked *picked)
{
    if (picked->job->request)
        render_request_tell(picked->job->request, STAGE_RENDERING, -1);
    struct encode_job *job = picked->job;
    struct error err = {0};
    size_t algorithm = algorithm_index(picked->settings.system);
    job->header.algorithm = (uint16_t)algorithm;
    if ((job->request && request_is_late(job->request, &err)) || !upload(loop, picked->scene, &err) ||
        !renderer_submit(loop->renderer, picked->scene->gpu, &picked->settings, ++loop->token, &err)) {
        fail_job(loop, job, &err);
        scene_entry_unref(picked->scene);
        return;
    }
    unsigned at = loop->in_flight_count++;
    loop->in_flight[at] = job;
    loop->in_flight_scene[at] = picked->scene;
    loop->in_flight_algorithm[at] = algorithm;
}

static void pop_in_flight(struct render_loop *loop)
{
    scene_entry_unref(loop->in_flight_scene[0]);
    loop->in_flight_count--;
    for (unsigned i = 0; i < loop->in_flight_count; i++) {
        loop->in_flight[i] = loop->in_flight[i + 1];
        loop->in_flight_scene[i] = loop->in_flight_scene[i + 1];
        loop->in_flight_algorithm[i] = loop->in_flight_algorithm[i + 1];
    }
}

static void lose_device(struct render_loop *loop, struct error *err)
{
    log_error("%s", err->message);
    loop->failed = true;
    while (loop->in_flight_count > 0) {
        fail_job(loop, loop->in_flight[0], err);
        pop_in_flight(loop);
    }
    loop->options.lost(loop->options.context);
}

static void deliver(struct render_loop *loop, const struct frame_info *info)
{
    struct encode_job *job = loop->in_flight[0];
    metrics_frame(loop->options.metrics, loop->in_flight_algorithm[0], info->frame_ms);
    pop_in_flight(loop);
    job->width = info->width;
    job->height = info->height;
    job->header.width = (uint16_t)info->width;
    job->header.height = (uint16_t)info->height;
    job->header.render_us = frame_microseconds(info->frame_ms);
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *view = render_loop_find_view(loop, job->header.view);
    if (view) {
        view->last = *info;
        view->unfinished = !info->converged;
    }
    pthread_mutex_unlock(&loop->mutex);
    if (job->request)
        render_request_tell(job->request, STAGE_ENCODING, -1);
    encode_pool_submit(loop->options.encoders, job);
}

/* True when a frame came out. */
static bool collect(struct render_loop *loop, bool wait)
{
    uint32_t width, height;
    enum pixel_format format;
    if (loop->failed || loop->in_flight_count == 0 || !renderer_oldest(loop->renderer, &width, &height, &format))
        return false;
    size_t size = (size_t)width * height * (format == PIXELS_RGBA32F ? 16 : 4);
    struct encode_job *job = loop->in_flight[0];
    if (!job->pixels && !encode_pool_buffer(loop->options.encoders, job, size)) {
        log_warning("out of memory for a frame of %u x %u", width, height);
        return false;
    }
    struct frame_info info;
    struct error err = {0};
    if (renderer_collect(loop->renderer, wait, job->pixels, size, &info, &err)) {
        deliver(loop, &info);
        return true;
    }
    if (err.code != ERROR_NONE)
        lose_device(loop, &err);
    return false;
}

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

static bool has_room(struct render_loop *loop)
{
    return !loop->failed && loop->in_flight_count < RENDERER_IN_FLIGHT &&
           encode_pool_pending(loop->options.encoders) + loop->in_flight_count < ENCODE_BACKLOG;
}

/* Between two frames of a comparison: what is in flight comes out, then each view that wants a frame gets one. False to stop comparing. */
static bool serve_streams(void *context)
{
    struct render_loop *loop = context;
    struct picked picked;
    uint64_t due = UINT64_MAX;
    bool stopping = false;
    for (unsigned round = 0; round < RENDER_LOOP_VIEWS; round++) {
        while (loop->in_flight_count > 0 && collect(loop, true))
            ;
        bool room = has_room(loop);
        pthread_mutex_lock(&loop->mutex);
        stopping = loop->stopping;
        bool found = !stopping && room && pick_view(loop, &picked, &due);
        pthread_mutex_unlock(&loop->mutex);
        if (!found)
            break;
        submit(loop, &picked);
    }
    return !stopping && !loop->failed && loop->in_flight_count == 0;
}

static void compare_thread_done(void *context) { render_loop_kick(context); }

/* The device's share of a comparison, here; the rest on the task's own thread. */
static void run_compare(struct render_loop *loop, struct encode_job *job)
{
    struct error err = {0};
    struct scene_entry *scene = scene_entry_ref(job->request->scene);
    job->header.algorithm = (uint16_t)algorithm_index(job->request->settings.system);
    render_request_tell(job->request, STAGE_RENDERING, -1);
    const struct compare_options options = {.renderer = loop->renderer,
                                            .pool = loop->options.pool,
                                            .encoders = loop->options.encoders,
                                            .between = serve_streams,
                                            .done = compare_thread_done,
                                            .context = loop};
    if (request_is_late(job->request, &err) || !serve_streams(loop) || !upload(loop, scene, &err) ||
        !(loop->comparing = compare_task_create(&options, scene->gpu, job, &err))) {
        if (err.code == ERROR_NONE)
            error_set(&err, ERROR_TRY_AGAIN, NULL, "the server is shutting down");
        fail_job(loop, job, &err);
    }
    scene_entry_unref(scene);
}

static void finish_compare(struct render_loop *loop, bool wait)
{
    if (loop->comparing && (wait || compare_task_is_done(loop->comparing))) {
        compare_task_destroy(loop->comparing);
        loop->comparing = NULL;
    }
}

/* One round: frees what is retired, collects what is done, submits what is wanted, sleeps when there was nothing to do. False to stop. */
static bool turn(struct render_loop *loop)
{
    struct picked picked;
    uint64_t due = UINT64_MAX;
    bool collected = collect(loop, false);
    pthread_mutex_lock(&loop->mutex);
    uint64_t seen = loop->events;
    struct scene_entry *retired = loop->retired;
    loop->retired = NULL;
    pthread_mutex_unlock(&loop->mutex);
    destroy_scenes(retired);
    finish_compare(loop, false);

    bool room = has_room(loop);
    pthread_mutex_lock(&loop->mutex);
    bool stopping = loop->stopping;
    bool may_compare = !stopping && !loop->failed && !loop->comparing;
    struct encode_job *compare = may_compare ? take_request(&loop->compares, &loop->compare_count) : NULL;
    bool found = !stopping && room && pick(loop, &picked, &due);
    if (!found && !collected && !stopping && !compare) {
        uint64_t poll = clock_us() + POLL_US;
        wait_change(loop, seen, loop->in_flight_count > 0 && !loop->failed && poll < due ? poll : due);
    }
    pthread_mutex_unlock(&loop->mutex);
    if (found)
        submit(loop, &picked);
    if (compare)
        run_compare(loop, compare);
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
        if (!(job = take_request(&loop->snapshots, &loop->snapshot_count)))
            job = take_request(&loop->compares, &loop->compare_count);
        pthread_mutex_unlock(&loop->mutex);
        if (job)
            fail_job(loop, job, &err);
    } while (job);
}

/* What could not be collected. */
static void drop_in_flight(struct render_loop *loop)
{
    struct error err = {0};
    error_set(&err, ERROR_TRY_AGAIN, NULL, "the server is shutting down");
    fail_job(loop, loop->in_flight[0], &err);
    pop_in_flight(loop);
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
    finish_compare(loop, true);
    refuse_requests(loop);
    while (loop->in_flight_count > 0 && collect(loop, true))
        ;
    while (loop->in_flight_count > 0)
        drop_in_flight(loop);
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
