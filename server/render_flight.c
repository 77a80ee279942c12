/* Frames between their submission to the renderer and the encoders. */
#include <stdatomic.h>

#include "base/log.h"
#include "clock.h"
#include "render_loop_state.h"
#include "scene_store.h"
#include "stage.h"

/* Pictures waiting for an encoder; past this, rendering more would only age them. */
#define ENCODE_BACKLOG 4

size_t render_algorithm_index(const struct shadow_system *system)
{
    size_t i = 0;
    while (i < shadow_system_count && shadow_systems[i] != system)
        i++;
    return i;
}

/* Drops the job of a frame or snapshot that failed, telling the network thread why. */
void render_flight_fail(struct render_loop *loop, struct encode_job *job, const struct error *err)
{
    job->err = *err;
    atomic_fetch_add(&loop->options.metrics->dropped[DROP_FAILED], 1);
    encode_pool_fail(loop->options.encoders, job);
}

bool render_request_is_late(const struct render_request *snapshot, struct error *err)
{
    if (atomic_load(&snapshot->cancelled))
        return !error_set(err, ERROR_TRY_AGAIN, NULL, "the request was cancelled");
    if (snapshot->deadline_us && clock_us() > snapshot->deadline_us)
        return !error_set(err, ERROR_TRY_AGAIN, "deadline_ms",
                          "deadline_ms: the deadline passed before this picture's turn came");
    return false;
}

bool render_flight_upload(struct render_loop *loop, struct scene_entry *scene, struct error *err)
{
    if (!scene->gpu)
        scene->gpu = render_scene_create(loop->renderer, scene->scene, err);
    return scene->gpu;
}

/* `picked->job` and its scene reference pass on, to the ring or to the failed. */
void render_flight_submit(struct render_loop *loop, const struct picked *picked)
{
    if (picked->job->request)
        render_request_tell(picked->job->request, STAGE_RENDERING, -1);
    struct encode_job *job = picked->job;
    struct error err = {0};
    size_t algorithm = render_algorithm_index(picked->settings.system);
    job->header.algorithm = (uint16_t)algorithm;
    if ((job->request && render_request_is_late(job->request, &err)) || !render_flight_upload(loop, picked->scene, &err) ||
        !renderer_submit(loop->renderer, picked->scene->gpu, &picked->settings, ++loop->token, &err)) {
        render_flight_fail(loop, job, &err);
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
        render_flight_fail(loop, loop->in_flight[0], err);
        pop_in_flight(loop);
    }
    loop->options.lost(loop->options.context);
}

/* A picture on request shows the refined shadows, as `gnomon render` writes it. */
static bool refine(struct render_loop *loop, const struct frame_info *info)
{
    struct encode_job *job = loop->in_flight[0];
    if (!job->request || info->converged || ++job->request->rounds >= STAGE_CONVERGE_MAX)
        return false;
    pthread_mutex_lock(&loop->mutex);
    bool stopping = loop->stopping;
    pthread_mutex_unlock(&loop->mutex);
    if (stopping)
        return false;
    struct picked again = {.job = job, .scene = scene_entry_ref(loop->in_flight_scene[0]), .settings = job->request->settings};
    pop_in_flight(loop);
    render_flight_submit(loop, &again);
    return true;
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
bool render_flight_collect(struct render_loop *loop, bool wait)
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
        if (!refine(loop, &info))
            deliver(loop, &info);
        return true;
    }
    if (err.code != ERROR_NONE)
        lose_device(loop, &err);
    return false;
}

bool render_flight_has_room(struct render_loop *loop)
{
    return !loop->failed && loop->in_flight_count < RENDERER_IN_FLIGHT &&
           encode_pool_pending(loop->options.encoders) + loop->in_flight_count < ENCODE_BACKLOG;
}

/* What could not be collected. */
void render_flight_drop(struct render_loop *loop)
{
    struct error err = {0};
    error_set(&err, ERROR_TRY_AGAIN, NULL, "the server is shutting down");
    render_flight_fail(loop, loop->in_flight[0], &err);
    pop_in_flight(loop);
}
