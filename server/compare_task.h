/* One compare.run: the device's share on the render thread, between the streams' frames; the reference, the figures and the difference picture
 * on a thread of its own, so that the streams go on. */
#pragma once

#include <stdbool.h>

#include "encode_pool.h"

struct compare_task;
struct job_pool;
struct render_scene;
struct renderer;

struct compare_options {
    struct renderer *renderer;
    struct job_pool *pool;
    struct encode_pool *encoders;   /* take the job back, with a picture or without */
    bool (*between)(void *context); /* render thread, before each frame; nothing may be in flight after it. False: stop */
    void (*done)(void *context);    /* the task's thread: compare_task_is_done() */
    void *context;
};

/* Render thread. Renders, then starts the thread, which takes `job` (and its request) over. NULL with the reason when it did not come to that:
 * the job is the caller's still. The scene must last as long as the request's reference. */
struct compare_task *compare_task_create(const struct compare_options *options, struct render_scene *uploaded,
                                         struct encode_job *job, struct error *err);
bool compare_task_is_done(const struct compare_task *task);
/* Stops it early if it is not done. */
void compare_task_destroy(struct compare_task *task);
