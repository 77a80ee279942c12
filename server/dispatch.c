#include "dispatch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "answer.h"
#include "base/error.h"
#include "http.h"
#include "numbers.h"
#include "pending.h"
#include "server.h"

const struct method *method_find(const char *name)
{
    for (const struct method *method = methods; method->name; method++)
        if (strcmp(method->name, name) == 0)
            return method;
    return NULL;
}

static bool may(const struct server *server, const struct call *call, struct error *err)
{
    const struct session *session = sessions_find((struct sessions *)&server->sessions, call->session);
    if (!call->method->control || (session && session->role == ROLE_CONTROL))
        return true;
    return error_set(err, ERROR_USAGE, "token", "this connection has a view token; for %s a control token is accepted",
                     call->method->name);
}

static enum outcome run_method(struct server *server, struct call *call, json_t **result, struct error *err)
{
    struct given given;
    struct params params = {0};
    if (!members_read(call->params, "", call->method->members, &params, &given, err))
        return OUTCOME_FAILED;
    return call->method->run(server, call, &params, given, result, err);
}

void dispatch_run(struct server *server, struct call *call)
{
    struct error err = {0};
    json_t *result = NULL;
    if (!may(server, call, &err)) {
        rpc_answer_error(server, call, RPC_FORBIDDEN, &err);
        call_free(call);
        return;
    }
    if (pending_count(server, call->session) >= PENDING_MAX) {
        error_set(&err, ERROR_TRY_AGAIN, NULL, "%d requests of this session are under way; answers to them come first",
                  PENDING_MAX);
        rpc_answer_error(server, call, RPC_BUSY, &err);
        call_free(call);
        return;
    }
    switch (run_method(server, call, &result, &err)) {
    case OUTCOME_DONE: rpc_answer(server, call, result ? result : json_object()); break;
    case OUTCOME_FAILED: rpc_answer_error(server, call, rpc_code_of(&err), &err); break;
    case OUTCOME_NO_VIEW:
        error_set(&err, ERROR_USAGE, "view",
                  "view: this session has no such view; the number that view.open returned is accepted");
        rpc_answer_error(server, call, RPC_NO_SUCH_VIEW, &err);
        break;
    case OUTCOME_SCENE:
    case OUTCOME_LATER: pending_add(server, call); return;
    }
    call_free(call);
}

static bool is_id(const json_t *id) { return json_is_string(id) || json_is_number(id); }

/* For what is no valid request: id null where it has no usable one (JSON-RPC 2.0, 5). */
static void refuse_message(struct server *server, uint64_t session, json_t *id, enum rpc_code code, const struct error *err)
{
    struct call call = {.session = session, .id = is_id(id) ? id : json_null()};
    rpc_answer_error(server, &call, code, err);
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
    json_t *message = json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_DECODE_ANY, &where);
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
        dispatch_run(server, call);
    } else if (method) {
        net_close(server->net, session, 1011, "out of memory");
    }
    json_decref(message);
}

void dispatch_render(struct server *server, uint64_t request, const char *allow_origin, const char *text, size_t size)
{
    struct error err = {0};
    json_error_t where;
    json_t *params = json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_DECODE_ANY, &where);
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
    dispatch_run(server, call);
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
