/* What the render thread does next. */
#include "clock.h"
#include "render_loop_state.h"
#include "scene_store.h"

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
bool render_pick_view(struct render_loop *loop, struct picked *out, uint64_t *due_us)
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
struct encode_job *render_pick_request(struct render_request **list, size_t *count)
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
    if (!(out->job = render_pick_request(&loop->snapshots, &loop->snapshot_count)))
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
bool render_pick(struct render_loop *loop, struct picked *out, uint64_t *due_us)
{
    bool first = !loop->snapshot_last && pick_snapshot(loop, out);
    bool found = first || render_pick_view(loop, out, due_us) || pick_snapshot(loop, out);
    if (found)
        loop->snapshot_last = out->job->request;
    return found;
}
