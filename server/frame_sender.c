#include "frame_sender.h"

#include <stdatomic.h>

#include "answer.h"
#include "clock.h"
#include "server.h"

static void tell_error(struct server *server, const struct encode_job *job)
{
    json_t *params = rpc_error_json(rpc_code_of(&job->err), &job->err);
    json_object_set_new(params, "view", json_integer(job->header.view));
    rpc_notify(server, job->session, NOTIFY_VIEW_ERROR, params);
}

static void count_drop(struct server *server, enum drop_reason reason) { atomic_fetch_add(&server->metrics.dropped[reason], 1); }

static void send(struct server *server, struct encode_job *job)
{
    const struct frame_header *header = &job->header;
    size_t size = job->packet->size;
    render_loop_sent(server->loop, header->view, header->frame, header->encode_us, size);
    atomic_fetch_add(&server->metrics.sent[header->codec], 1);
    atomic_fetch_add(&server->metrics.bytes_sent, size);
    net_send(server->net, job->session, job->packet);
    job->packet = NULL;
    encode_job_destroy(job);
}

void frame_sender_take(struct server *server, struct encode_job *job)
{
    const struct frame_header *header = &job->header;
    struct view_record *view = sessions_find_view(&server->sessions, job->session, header->view);
    if (!view) {
        count_drop(server, DROP_CLOSED);
    } else if (job->err.code != ERROR_NONE) {
        render_loop_lost(server->loop, header->view, header->frame);
        tell_error(server, job);
    } else if (!view->held && render_loop_may_send(server->loop, view->id)) {
        send(server, job);
        return;
    } else {
        if (view->held) { /* credit allows two: cannot be, unless STREAM_IN_FLIGHT grows */
            render_loop_lost(server->loop, view->id, view->held->header.frame);
            count_drop(server, DROP_CREDIT);
            frame_sender_drop(view);
        }
        view->held = job;
        view->held_us = clock_us();
        return;
    }
    encode_job_destroy(job);
}

void frame_sender_acked(struct server *server, struct view_record *view)
{
    struct encode_job *job = view->held;
    if (!job || !render_loop_may_send(server->loop, view->id))
        return;
    view->held = NULL;
    if (!render_loop_is_stale(server->loop, view->id, job->header.frame, view->held_us)) {
        send(server, job);
        return;
    }
    render_loop_lost(server->loop, view->id, job->header.frame);
    count_drop(server, DROP_CREDIT);
    encode_job_destroy(job);
}

void frame_sender_drop(struct view_record *view)
{
    encode_job_destroy(view->held);
    view->held = NULL;
}
