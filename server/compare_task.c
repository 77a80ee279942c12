#include "compare_task.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "comparison.h"
#include "difference.h"
#include "figures.h"
#include "measure.h"
#include "render_request.h"
#include "scene_store.h"
#include "stage.h"

struct compare_task {
    struct compare_options options;
    struct encode_job *job;
    struct scene_entry *scene; /* one reference: the thread outlives the request when that is answered first */
    struct stage stage;
    struct comparison comparison;
    pthread_t thread;
    atomic_bool done, stopped;
};

/* From any of the tracer's threads. */
static bool report(void *context, double done)
{
    struct compare_task *task = context;
    struct render_request *request = task->job->request;
    render_request_tell(request, STAGE_COMPARING, done);
    return !atomic_load(&request->cancelled) && !atomic_load(&task->stopped);
}

static bool before_frame(void *context, struct error *err)
{
    struct compare_task *task = context;
    if (!atomic_load(&task->job->request->cancelled) && task->options.between(task->options.context))
        return true;
    return error_set(err, ERROR_TRY_AGAIN, NULL, "the comparison was stopped");
}

static bool paint(struct compare_task *task, struct error *err)
{
    struct encode_job *job = task->job;
    const struct comparison *c = &task->comparison;
    bool numbers = job->header.codec == GNMF_EXR;
    if (!encode_pool_buffer(task->options.encoders, job, (size_t)c->width * c->height * (numbers ? 16 : 4)))
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the difference picture");
    if (numbers)
        difference_numbers(c, job->pixels);
    else
        difference_paint(c, job->pixels);
    job->width = c->width;
    job->height = c->height;
    job->header.width = (uint16_t)c->width;
    job->header.height = (uint16_t)c->height;
    return true;
}

static void *task_main(void *argument)
{
    struct compare_task *task = argument;
    struct encode_job *job = task->job;
    struct render_request *request = job->request;
    const struct reference_progress progress = {report, task};
    bool good = comparison_trace(&task->stage, &request->against, &progress, &task->comparison, &job->err);
    if (good)
        figures_add_comparison(request->figures, &request->against, &task->stage, &task->comparison);
    if (good && request->difference)
        good = paint(task, &job->err);
    comparison_finish(&task->comparison);
    bool picture = good && request->difference;
    if (picture)
        render_request_tell(request, STAGE_ENCODING, -1);
    /* From here on the job, and the request with it, is the network thread's. */
    if (picture)
        encode_pool_submit(task->options.encoders, job);
    else if (good)
        encode_pool_return(task->options.encoders, job);
    else
        encode_pool_fail(task->options.encoders, job);
    atomic_store(&task->done, true);
    task->options.done(task->options.context);
    return NULL;
}

static bool render(struct compare_task *task, struct error *err)
{
    struct render_request *request = task->job->request;
    struct measurement measured;
    if (!measure_frames(&task->stage, request->frames, request->moving, NULL, &measured, err))
        return false;
    task->job->header.render_us = frame_microseconds(measured.median_ms);
    request->figures = figures_render(task->stage.scene, &request->settings, renderer_device(task->options.renderer), &measured);
    if (!request->figures)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the figures");
    return comparison_render(&task->stage, &request->against, &task->comparison, err);
}

static void fill_header(struct encode_job *job)
{
    const struct render_request *request = job->request;
    bool lossless = request->codec == GNMF_PNG || request->codec == GNMF_EXR;
    job->header.kind = GNMF_DIFFERENCE;
    job->header.codec = request->codec;
    job->header.flags = (uint16_t)(GNMF_KEY | GNMF_STILL | (lossless ? GNMF_LOSSLESS : 0));
    job->header.request_id = request->request_id;
}

struct compare_task *compare_task_create(const struct compare_options *options, struct render_scene *uploaded,
                                         struct encode_job *job, struct error *err)
{
    struct compare_task *task = calloc(1, sizeof *task);
    if (!task) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a comparison");
        return NULL;
    }
    const struct render_request *request = job->request;
    task->options = *options;
    task->job = job;
    task->scene = scene_entry_ref(request->scene);
    task->stage = (struct stage){.scene = request->scene->scene,
                                 .settings = request->settings,
                                 .pool = options->pool,
                                 .renderer = options->renderer,
                                 .uploaded = uploaded,
                                 .before_frame = before_frame,
                                 .context = task};
    fill_header(job);
    int failure = 0;
    if (render(task, err) && (failure = pthread_create(&task->thread, NULL, task_main, task)) == 0)
        return task;
    if (failure)
        error_set(err, ERROR_TRY_AGAIN, NULL, "cannot start a thread for the comparison: %s", strerror(failure));
    comparison_finish(&task->comparison);
    scene_entry_unref(task->scene);
    free(task);
    return NULL;
}

bool compare_task_is_done(const struct compare_task *task) { return atomic_load(&task->done); }

void compare_task_destroy(struct compare_task *task)
{
    atomic_store(&task->stopped, true);
    pthread_join(task->thread, NULL);
    scene_entry_unref(task->scene);
    free(task);
}
