#include "dispatch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/log.h"
#include "http.h"
#include "numbers.h"
#include "output.h"
#include "server.h"

const struct method *method_find(const char *name)
{
    for (const struct method *method = methods; method->name; method++)
        if (strcmp(method->name, name) == 0)
            return method;
    return NULL;
}

enum rpc_code dispatch_code(const struct error *err)
{
    switch (err->code) {
    case ERROR_USAGE: return RPC_INVALID_PARAMS;
    case ERROR_DATA: return RPC_BAD_SCENE;
    case ERROR_NO_INPUT: return RPC_NO_SUCH_SCENE;
    case ERROR_NO_DEVICE: return RPC_NO_DEVICE;
    case ERROR_IO: return RPC_IO;
    case ERROR_TRY_AGAIN: return RPC_BUSY;
    case ERROR_NONE:
    case ERROR_BUG: break;
    }
    return RPC_INTERNAL;
}

json_t *dispatch_error_json(enum rpc_code code, const struct error *err)
{
    /* Our sentences end with what would have been accepted: "...; 1 to 100 is accepted". */
    const char *limit = strrchr(err->message, ';');
    json_t *data = json_pack("{s:o}", "field", json_text(err->field));
    if (limit)
        json_object_set_new(data, "limit", json_text(limit + 1 + strspn(limit + 1, " ")));
    return json_pack("{s:i, s:o, s:o*}", "code", (int)code, "message", json_text(err->message), "data", data);
}

static void send_json(struct server *server, uint64_t session, json_t *message)
{
    char *text = message ? json_dumps(message, JSON_COMPACT) : NULL;
    struct packet *packet = text ? packet_from_text(text, strlen(text)) : NULL;
    if (packet)
        net_send(server->net, session, packet);
    else
        net_close(server->net, session, 1011, "out of memory");
    free(text);
    json_decref(message);
}

void dispatch_notify(struct server *server, uint64_t session, const char *method, json_t *params)
{
    send_json(server, session, json_pack("{s:s, s:s, s:o}", "jsonrpc", "2.0", "method", method, "params", params));
}

/* Takes `result` over. */
static void answer(struct server *server, const struct call *call, json_t *result)
{
    if (call->id)
        send_json(server, call->session, json_pack("{s:s, s:O, s:o}", "jsonrpc", "2.0", "id", call->id, "result", result));
    else
        json_decref(result);
}

/* "The Server MUST NOT reply to a Notification" (JSON-RPC 2.0, 4.1). */
static void answer_error(struct server *server, const struct call *call, enum rpc_code code, const struct error *err)
{
    if (call->http) {
        http_answer_error(server, call->session, call->allow_origin, code, err);
        return;
    }
    if (!call->id) {
        log_debug("a notification failed: %s", err->message);
        return;
    }
    send_json(server, call->session,
              json_pack("{s:s, s:O, s:o}", "jsonrpc", "2.0", "id", call->id, "error", dispatch_error_json(code, err)));
}

static void call_destroy(struct call *call)
{
    scene_entry_unref(call->scene);
    json_decref(call->id);
    json_decref(call->params);
    free(call);
}

static bool may(const struct server *server, const struct call *call, struct error *err)
{
    const struct session *session = sessions_find((struct sessions *)&server->sessions, call->session);
    if (!call->method->control || (session && session->role == ROLE_CONTROL))
        return true;
    return error_set(err, ERROR_USAGE, "token", "%s needs a control token; this connection has a view token", call->method->name);
}

static enum outcome run_method(struct server *server, struct call *call, json_t **result, struct error *err)
{
    struct given given;
    struct params params = {0};
    if (!members_read(call->params, "", call->method->members, &params, &given, err))
        return OUTCOME_FAILED;
    return call->method->run(server, call, &params, given, result, err);
}

/* Runs a call and answers it, or keeps it for later. Takes it over. */
static void run(struct server *server, struct call *call)
{
    struct error err = {0};
    json_t *result = NULL;
    if (!may(server, call, &err)) {
        answer_error(server, call, RPC_FORBIDDEN, &err);
        call_destroy(call);
        return;
    }
    switch (run_method(server, call, &result, &err)) {
    case OUTCOME_DONE: answer(server, call, result ? result : json_object()); break;
    case OUTCOME_FAILED: answer_error(server, call, dispatch_code(&err), &err); break;
    case OUTCOME_NO_VIEW:
        error_set(&err, ERROR_USAGE, "view",
                  "view: this session has no such view; the number that view.open returned is accepted");
        answer_error(server, call, RPC_NO_SUCH_VIEW, &err);
        break;
    case OUTCOME_SCENE:
        call->link = server->waiting;
        server->waiting = call;
        return;
    case OUTCOME_LATER:
        call->link = server->pictures;
        server->pictures = call;
        return;
    }
    call_destroy(call);
}

static bool is_id(const json_t *id) { return json_is_string(id) || json_is_number(id); }

/* For what is no valid request: id null where it has no usable one (JSON-RPC 2.0, 5). */
static void refuse_message(struct server *server, uint64_t session, json_t *id, enum rpc_code code, const struct error *err)
{
    struct call call = {.session = session, .id = is_id(id) ? id : json_null()};
    answer_error(server, &call, code, err);
}

static bool check_envelope(const json_t *message, struct error *err)
{
    static const char *const members[] = {"jsonrpc", "id", "method", "params", NULL};
    const char *key;
    json_t *value;
    if (!json_is_object(message))
        return error_set(err, ERROR_USAGE, "", "a message is one JSON object; batches are not accepted");
    json_object_foreach((json_t *)message, key, value) if (name_index(members, key) < 0) return error_set(
        err, ERROR_USAGE, key, "unknown member %.60s; accepted: jsonrpc, id, method, params", key);
    const char *version = json_string_value(json_object_get(message, "jsonrpc"));
    if (!version || strcmp(version, "2.0") != 0)
        return error_set(err, ERROR_USAGE, "jsonrpc", "jsonrpc is missing or wrong; \"2.0\" is accepted");
    if (!json_is_string(json_object_get(message, "method")))
        return error_set(err, ERROR_USAGE, "method", "method is missing; a string is accepted");
    const json_t *id = json_object_get(message, "id");
    if (id && !is_id(id))
        return error_set(err, ERROR_USAGE, "id", "id has the wrong type; a string or a number is accepted");
    return true;
}

void dispatch_message(struct server *server, uint64_t session, const char *text, size_t size)
{
    struct error err = {0};
    json_error_t where;
    json_t *message = json_loadb(text, size, JSON_REJECT_DUPLICATES, &where);
    json_t *id = json_is_object(message) ? json_object_get(message, "id") : NULL;
    const struct method *method = NULL;
    if (!message) {
        error_set(&err, ERROR_USAGE, "", "this is no JSON (line %d, column %d: %.100s); one JSON-RPC 2.0 object is accepted",
                  where.line, where.column, where.text);
        refuse_message(server, session, NULL, RPC_PARSE_ERROR, &err);
    } else if (!check_envelope(message, &err)) {
        refuse_message(server, session, id, RPC_INVALID_REQUEST, &err);
    } else if (!(method = method_find(json_string_value(json_object_get(message, "method")))) && id) {
        error_set(&err, ERROR_USAGE, "method", "there is no method %.60s; proto/gnomon.openrpc.json lists them",
                  json_string_value(json_object_get(message, "method")));
        refuse_message(server, session, id, RPC_METHOD_NOT_FOUND, &err);
    }
    struct call *call = method ? calloc(1, sizeof *call) : NULL;
    if (call) {
        call->session = session;
        call->method = method;
        call->id = json_incref(id);
        call->params = json_incref(json_object_get(message, "params"));
        run(server, call);
    } else if (method) {
        net_close(server->net, session, 1011, "out of memory");
    }
    json_decref(message);
}

void dispatch_render(struct server *server, uint64_t request, const char *allow_origin, const char *text, size_t size)
{
    struct error err = {0};
    json_error_t where;
    json_t *params = json_loadb(text, size, JSON_REJECT_DUPLICATES, &where);
    struct call *call = params ? calloc(1, sizeof *call) : NULL;
    if (!call) {
        error_set(&err, ERROR_USAGE, "",
                  "the body is no JSON (line %d, column %d: %.100s); an object with render.snapshot's members is accepted",
                  where.line, where.column, where.text);
        http_answer_error(server, request, allow_origin, RPC_PARSE_ERROR, &err);
        json_decref(params);
        return;
    }
    call->session = request;
    call->http = true;
    call->params = params;
    call->method = method_find(METHOD_RENDER_SNAPSHOT);
    snprintf(call->allow_origin, sizeof call->allow_origin, "%s", allow_origin ? allow_origin : "");
    run(server, call);
}

void dispatch_scenes_ready(struct server *server)
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
        run(server, calls);
    }
    scene_store_forget_failed(server->scenes);
}

static void snapshot_destroy(struct snapshot *snapshot)
{
    scene_entry_unref(snapshot->scene);
    free(snapshot);
}

/* WebSocket: the frame first, then the answer that names it. */
static void answer_picture(struct server *server, const struct call *call, struct encode_job *job)
{
    size_t bytes = job->packet->size - GNMF_HEADER_SIZE;
    net_send(server->net, call->session, job->packet);
    job->packet = NULL;
    answer(server, call,
           json_pack("{s:I, s:[i,i], s:s, s:I, s:I, s:I}", "request_id", (json_int_t)job->header.request_id, "size",
                     (int)job->width, (int)job->height, "format", codec_names[job->header.codec], "bytes", (json_int_t)bytes,
                     "render_us", (json_int_t)job->header.render_us, "encode_us", (json_int_t)job->header.encode_us));
}

void dispatch_picture(struct server *server, struct encode_job *job)
{
    struct snapshot *snapshot = job->snapshot;
    job->snapshot = NULL;
    struct call **at = &server->pictures;
    while (*at && (*at)->snapshot != snapshot)
        at = &(*at)->link;
    struct call *call = *at;
    if (call) {
        *at = call->link;
        if (job->err.code != ERROR_NONE)
            answer_error(server, call, dispatch_code(&job->err), &job->err);
        else if (call->http)
            http_answer_picture(server, call->session, call->allow_origin, job);
        else
            answer_picture(server, call, job);
        call_destroy(call);
    }
    snapshot_destroy(snapshot);
}

static struct call **forget_first(struct call **at, uint64_t session)
{
    while (*at && (*at)->session != session)
        at = &(*at)->link;
    return *at ? at : NULL;
}

void dispatch_forget(struct server *server, uint64_t session)
{
    struct call **lists[] = {&server->waiting, &server->pictures};
    for (size_t i = 0; i < 2; i++)
        for (struct call **at; (at = forget_first(lists[i], session));) {
            struct call *call = *at;
            *at = call->link;
            if (call->snapshot)
                atomic_store(&call->snapshot->cancelled, true);
            call_destroy(call);
        }
}

enum outcome dispatch_scene(struct server *server, struct call *call, const char *name, struct scene_entry **out,
                            struct error *err)
{
    struct scene_entry *evicted;
    struct scene_entry *entry = scene_store_get(server->scenes, name ? name : server->first_scene, &evicted, err);
    if (evicted)
        render_loop_retire(server->loop, evicted);
    scene_entry_unref(call->scene);
    call->scene = NULL;
    if (!entry)
        return OUTCOME_FAILED;
    if (entry->status == SCENE_LOADING) {
        call->scene = entry;
        return OUTCOME_SCENE;
    }
    if (entry->status == SCENE_FAILED) {
        *err = entry->err;
        scene_entry_unref(entry);
        return OUTCOME_FAILED;
    }
    *out = entry;
    return OUTCOME_DONE;
}
