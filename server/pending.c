#include "pending.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "answer.h"
#include "base/error.h"
#include "dispatch.h"
#include "http.h"
#include "server.h"

void call_free(struct call *call)
{
    scene_entry_unref(call->scene);
    json_decref(call->id);
    json_decref(call->params);
    free(call);
}

/* A client that does not read what it is told is not told more. */
static void tell(struct server *server, struct call *call, enum request_stage stage, int permille)
{
    if (!call->id || call->http || (call->told && call->stage == (int)stage && call->permille == permille) ||
        net_queued(server->net, call->session) > 0)
        return;
    call->told = true;
    call->stage = stage;
    call->permille = permille;
    json_t *done = permille < 0 ? json_null() : json_real(permille / 1000.0);
    rpc_notify(server, call->session, NOTIFY_PROGRESS,
               json_pack("{s:O, s:s, s:o}", "id", call->id, "stage", request_stage_names[stage], "done", done));
}

static void tell_request(struct server *server, struct call *call)
{
    tell(server, call, (enum request_stage)atomic_load(&call->request->stage), atomic_load(&call->request->permille));
}

void pending_add(struct server *server, struct call *call)
{
    struct call **list = call->request ? &server->pictures : &server->waiting;
    call->link = *list;
    *list = call;
    if (call->request)
        tell_request(server, call);
    else
        tell(server, call, STAGE_LOADING, -1);
}

void pending_tell(struct server *server)
{
    for (struct call *call = server->pictures; call; call = call->link)
        tell_request(server, call);
}

size_t pending_count(const struct server *server, uint64_t session)
{
    size_t count = 0;
    const struct call *const lists[] = {server->waiting, server->pictures};
    for (size_t i = 0; i < 2; i++)
        for (const struct call *call = lists[i]; call; call = call->link)
            count += call->session == session;
    return count;
}

void pending_scenes_ready(struct server *server)
{
    struct call *calls = server->waiting;
    server->waiting = NULL;
    for (struct call *next; calls; calls = next) {
        next = calls->link;
        if (calls->scene->status == SCENE_LOADING) {
            calls->link = server->waiting;
            server->waiting = calls;
            continue;
        }
        dispatch_run(server, calls);
    }
    scene_store_forget_failed(server->scenes);
}

/* WebSocket: the frame first, then the answer that names it. */
static json_t *send_picture(struct server *server, const struct call *call, struct encode_job *job)
{
    size_t bytes = job->packet->size - GNMF_HEADER_SIZE;
    net_send(server->net, call->session, job->packet);
    job->packet = NULL;
    return json_pack("{s:I, s:[i,i], s:s, s:I, s:I, s:I}", "request_id", (json_int_t)job->header.request_id, "size",
                     (int)job->width, (int)job->height, "format", codec_names[job->header.codec], "bytes", (json_int_t)bytes,
                     "render_us", (json_int_t)job->header.render_us, "encode_us", (json_int_t)job->header.encode_us);
}

static json_t *send_comparison(struct server *server, const struct call *call, struct encode_job *job)
{
    if (job->packet)
        net_send(server->net, call->session, job->packet);
    job->packet = NULL;
    json_t *figures = job->request->figures;
    job->request->figures = NULL;
    return figures;
}

void pending_answer(struct server *server, struct encode_job *job)
{
    struct render_request *request = job->request;
    job->request = NULL;
    struct call **at = &server->pictures;
    while (*at && (*at)->request != request)
        at = &(*at)->link;
    struct call *call = *at;
    if (call) {
        *at = call->link;
        job->request = request;
        if (job->err.code != ERROR_NONE)
            rpc_answer_error(server, call, rpc_code_of(&job->err), &job->err);
        else if (call->http)
            http_answer_picture(server, call->session, call->allow_origin, job);
        else
            rpc_answer(server, call, request->compare ? send_comparison(server, call, job) : send_picture(server, call, job));
        job->request = NULL;
        call_free(call);
    }
    render_request_destroy(request);
}

static void drop(struct call **at)
{
    struct call *call = *at;
    *at = call->link;
    if (call->request)
        atomic_store(&call->request->cancelled, true);
    call_free(call);
}

/* In either list; `id` NULL: any of the session's. NULL when there is none. */
static struct call **find(struct server *server, uint64_t session, const json_t *id)
{
    struct call **lists[] = {&server->waiting, &server->pictures};
    for (size_t i = 0; i < 2; i++)
        for (struct call **at = lists[i]; *at; at = &(*at)->link)
            if ((*at)->session == session && (!id || ((*at)->id && json_equal((*at)->id, id))))
                return at;
    return NULL;
}

bool pending_cancel(struct server *server, uint64_t session, const json_t *id)
{
    struct error err = {0};
    struct call **at = find(server, session, id);
    if (!at)
        return false;
    error_set(&err, ERROR_TRY_AGAIN, NULL, "the request was given up by $/cancel");
    rpc_answer_error(server, *at, RPC_CANCELLED, &err);
    drop(at);
    return true;
}

void pending_forget(struct server *server, uint64_t session)
{
    for (struct call **at; (at = find(server, session, NULL));)
        drop(at);
}
