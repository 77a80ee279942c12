#include "render_loop.h"

#include <assert.h>
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "clock.h"
#include "scene_store.h"

/* How often to ask whether the GPU is done while there is nothing else to do. */
#define POLL_US        500
/* Pictures waiting for an encoder; past this, rendering more would only age them. */
#define ENCODE_BACKLOG 4

struct render_loop {
    struct render_loop_options options;
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t changed;

    /* Guarded. */
    struct stream_view views[RENDER_LOOP_VIEWS];
    struct snapshot *snapshots; /* oldest first */
    size_t snapshot_count;
    struct scene_entry *retired, *remaining; /* `remaining`: at the end, not ours to free */
    bool stopping, started, failed;
    uint64_t events; /* counts every change: what the thread has seen tells whether to sleep */
    struct error start_error;

    /* Render thread. */
    struct renderer *renderer;
    struct device_info device;
    struct encode_job *in_flight[RENDERER_IN_FLIGHT]; /* submitted, oldest first */
    struct scene_entry *in_flight_scene[RENDERER_IN_FLIGHT];
    size_t in_flight_algorithm[RENDERER_IN_FLIGHT];
    unsigned in_flight_count;
    unsigned turn;      /* where the search for the next view begins */
    bool snapshot_last; /* snapshots and views take turns */
    uint64_t token;
};

/* What the thread picked to render, copied out of the lock. */
struct picked {
    struct encode_job *job;
    struct scene_entry *scene; /* one reference */
    struct render_settings settings;
};

static void changed(struct render_loop *loop)
{
    loop->events++;
    pthread_cond_signal(&loop->changed);
}

static struct stream_view *find_view(struct render_loop *loop, uint32_t view)
{
    for (size_t i = 0; i < RENDER_LOOP_VIEWS; i++)
        if (loop->views[i].id == view && view != 0)
            return &loop->views[i];
    return NULL;
}

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
static bool pick_snapshot(struct render_loop *loop, struct picked *out)
{
    struct snapshot *snapshot = loop->snapshots;
    if (!snapshot || !(out->job = encode_job_create()))
        return false;
    loop->snapshots = snapshot->link;
    loop->snapshot_count--;
    out->scene = scene_entry_ref(snapshot->scene);
    out->settings = snapshot->settings;
    out->job->session = snapshot->session;
    out->job->quality = snapshot->quality;
    out->job->snapshot = snapshot;
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
        loop->snapshot_last = out->job->snapshot;
    return found;
}

static bool snapshot_is_late(const struct snapshot *snapshot, struct error *err)
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
    struct encode_job *job = picked->job;
    struct error err = {0};
    size_t algorithm = algorithm_index(picked->settings.system);
    job->header.algorithm = (uint16_t)algorithm;
    if ((job->snapshot && snapshot_is_late(job->snapshot, &err)) || !upload(loop, picked->scene, &err) ||
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
    struct stream_view *view = find_view(loop, job->header.view);
    if (view)
        view->last = *info;
    pthread_mutex_unlock(&loop->mutex);
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

    bool room = has_room(loop);
    pthread_mutex_lock(&loop->mutex);
    bool stopping = loop->stopping;
    bool found = !stopping && room && pick(loop, &picked, &due);
    if (!found && !collected && !stopping) {
        uint64_t poll = clock_us() + POLL_US;
        wait_change(loop, seen, loop->in_flight_count > 0 && !loop->failed && poll < due ? poll : due);
    }
    pthread_mutex_unlock(&loop->mutex);
    if (found)
        submit(loop, &picked);
    return !stopping;
}

/* Snapshots that will not be rendered any more go back with a reason. */
static void refuse_snapshots(struct render_loop *loop)
{
    struct error err = {0};
    error_set(&err, ERROR_TRY_AGAIN, NULL, "the server is shutting down");
    struct picked picked;
    pthread_mutex_lock(&loop->mutex);
    while (pick_snapshot(loop, &picked)) {
        scene_entry_unref(picked.scene);
        pthread_mutex_unlock(&loop->mutex);
        fail_job(loop, picked.job, &err);
        pthread_mutex_lock(&loop->mutex);
    }
    pthread_mutex_unlock(&loop->mutex);
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
    refuse_snapshots(loop);
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
    changed(loop);
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

bool render_loop_open(struct render_loop *loop, uint32_t view, uint64_t session, struct scene_entry *scene,
                      const struct view_state *state)
{
    assert(view != 0 && scene->status == SCENE_READY);
    bool found = false;
    pthread_mutex_lock(&loop->mutex);
    for (size_t i = 0; i < RENDER_LOOP_VIEWS && !found; i++) {
        if (loop->views[i].id != 0)
            continue;
        loop->views[i] = (struct stream_view){.id = view, .session = session, .scene = scene_entry_ref(scene)};
        enum drop_reason reason;
        stream_view_update(&loop->views[i], state, clock_us(), &reason);
        changed(loop);
        found = true;
    }
    pthread_mutex_unlock(&loop->mutex);
    return found;
}

void render_loop_update(struct render_loop *loop, uint32_t view, const struct view_state *state)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = find_view(loop, view);
    if (v) {
        enum drop_reason reason;
        if (stream_view_update(v, state, clock_us(), &reason))
            atomic_fetch_add(&loop->options.metrics->dropped[reason], 1);
        changed(loop);
    }
    pthread_mutex_unlock(&loop->mutex);
}

void render_loop_close(struct render_loop *loop, uint32_t view)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = find_view(loop, view);
    if (v) {
        scene_entry_unref(v->scene);
        *v = (struct stream_view){0};
    }
    pthread_mutex_unlock(&loop->mutex);
}

bool render_loop_ack(struct render_loop *loop, uint32_t view, uint64_t frame)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = find_view(loop, view);
    bool ok = v && stream_view_ack(v, frame, clock_us());
    changed(loop);
    pthread_mutex_unlock(&loop->mutex);
    return ok;
}

void render_loop_sent(struct render_loop *loop, uint32_t view, uint64_t frame, uint32_t encode_us, size_t bytes)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = find_view(loop, view);
    if (v)
        stream_view_sent(v, frame, encode_us, bytes, clock_us());
    pthread_mutex_unlock(&loop->mutex);
}

void render_loop_lost(struct render_loop *loop, uint32_t view, uint64_t frame)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = find_view(loop, view);
    if (v)
        stream_view_lost(v, frame);
    changed(loop);
    pthread_mutex_unlock(&loop->mutex);
}

void render_loop_blocked(struct render_loop *loop, uint64_t session, bool blocked)
{
    pthread_mutex_lock(&loop->mutex);
    for (size_t i = 0; i < RENDER_LOOP_VIEWS; i++)
        if (loop->views[i].id != 0 && loop->views[i].session == session)
            loop->views[i].blocked = blocked;
    changed(loop);
    pthread_mutex_unlock(&loop->mutex);
}

bool render_loop_snapshot(struct render_loop *loop, struct snapshot *snapshot)
{
    pthread_mutex_lock(&loop->mutex);
    bool room = loop->snapshot_count < RENDER_LOOP_SNAPSHOTS;
    if (room) {
        struct snapshot **end = &loop->snapshots;
        while (*end)
            end = &(*end)->link;
        *end = snapshot;
        snapshot->link = NULL;
        loop->snapshot_count++;
        changed(loop);
    }
    pthread_mutex_unlock(&loop->mutex);
    return room;
}

bool render_loop_view(struct render_loop *loop, uint32_t view, struct stream_view *out)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = find_view(loop, view);
    if (v)
        *out = *v;
    pthread_mutex_unlock(&loop->mutex);
    return v;
}

void render_loop_retire(struct render_loop *loop, struct scene_entry *scene)
{
    pthread_mutex_lock(&loop->mutex);
    scene->link = loop->retired;
    loop->retired = scene;
    changed(loop);
    pthread_mutex_unlock(&loop->mutex);
}

void render_loop_kick(struct render_loop *loop)
{
    pthread_mutex_lock(&loop->mutex);
    changed(loop);
    pthread_mutex_unlock(&loop->mutex);
}

const struct device_info *render_loop_device(const struct render_loop *loop) { return &loop->device; }
