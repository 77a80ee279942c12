/* The render thread's part in comparisons, beside the streams. */
#include "compare_task.h"
#include "render_loop_state.h"
#include "scene_store.h"

/* Between two frames of a comparison: what is in flight comes out, then each view that wants a frame gets one. False to stop comparing. */
static bool serve_streams(void *context)
{
    struct render_loop *loop = context;
    struct picked picked;
    uint64_t due = UINT64_MAX;
    bool stopping = false;
    for (unsigned round = 0; round < RENDER_LOOP_VIEWS; round++) {
        while (loop->in_flight_count > 0 && render_flight_collect(loop, true))
            ;
        bool room = render_flight_has_room(loop);
        pthread_mutex_lock(&loop->mutex);
        stopping = loop->stopping;
        bool found = !stopping && room && render_pick_view(loop, &picked, &due);
        pthread_mutex_unlock(&loop->mutex);
        if (!found)
            break;
        render_flight_submit(loop, &picked);
    }
    return !stopping && !loop->failed && loop->in_flight_count == 0;
}

static void compare_thread_done(void *context) { render_loop_kick(context); }

/* The device's share of a comparison, here; the rest on the task's own thread. */
void render_compare_run(struct render_loop *loop, struct encode_job *job)
{
    struct error err = {0};
    struct scene_entry *scene = scene_entry_ref(job->request->scene);
    job->header.algorithm = (uint16_t)render_algorithm_index(job->request->settings.system);
    render_request_tell(job->request, STAGE_RENDERING, -1);
    const struct compare_options options = {.renderer = loop->renderer,
                                            .pool = loop->options.pool,
                                            .encoders = loop->options.encoders,
                                            .between = serve_streams,
                                            .done = compare_thread_done,
                                            .context = loop};
    if (render_request_is_late(job->request, &err) || !serve_streams(loop) || !render_flight_upload(loop, scene, &err) ||
        !(loop->comparing = compare_task_create(&options, scene->gpu, job, &err))) {
        if (err.code == ERROR_NONE)
            error_set(&err, ERROR_TRY_AGAIN, NULL, "the server is shutting down");
        render_flight_fail(loop, job, &err);
    }
    scene_entry_unref(scene);
}

void render_compare_finish(struct render_loop *loop, bool wait)
{
    if (loop->comparing && (wait || compare_task_is_done(loop->comparing))) {
        compare_task_destroy(loop->comparing);
        loop->comparing = NULL;
    }
}
