/* JSON-RPC 2.0: one table of methods, one way in for text messages and for POST /v1/render, one way out for answers. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include "members.h"

struct error;
struct encode_job;
struct scene_entry;
struct server;

/* proto/README.md lists them. */
enum rpc_code {
    RPC_PARSE_ERROR = -32700,
    RPC_INVALID_REQUEST = -32600,
    RPC_METHOD_NOT_FOUND = -32601,
    RPC_INVALID_PARAMS = -32602,
    RPC_INTERNAL = -32603,
    RPC_NO_SUCH_SCENE = -32000,
    RPC_BAD_SCENE = -32001,
    RPC_NO_SUCH_VIEW = -32002,
    RPC_FORBIDDEN = -32003,
    RPC_BUSY = -32004,
    RPC_IO = -32005,
    RPC_NO_DEVICE = -32006,
};

enum outcome {
    OUTCOME_DONE,   /* *result is the answer */
    OUTCOME_FAILED, /* err says why */
    OUTCOME_NO_VIEW,
    OUTCOME_SCENE, /* run again when call->scene has been loaded */
    OUTCOME_LATER, /* answered when its picture is ready */
};

/* A request under way. */
struct call {
    struct call *link;
    uint64_t session;
    bool http;      /* answered with a picture or a status */
    json_t *id;     /* NULL: a notification, or HTTP */
    json_t *params; /* may be NULL */
    const struct method *method;
    struct scene_entry *scene; /* waited for; one reference */
    struct snapshot *snapshot; /* under way */
    char allow_origin[256];    /* HTTP: "" none */
};

struct method {
    const char *name;
    const struct member *members;
    size_t params_size;
    bool control; /* not for view tokens */
    enum outcome (*run)(struct server *server, struct call *call, const void *params, struct given given, json_t **result,
                        struct error *err);
};

extern const struct method *const methods[]; /* ended by NULL */
const struct method *method_find(const char *name);

/* One text message of a session. */
void dispatch_message(struct server *server, uint64_t session, const char *text, size_t size);
/* The body of POST /v1/render. */
void dispatch_render(struct server *server, uint64_t request, const char *allow_origin, const char *text, size_t size);

/* Runs the calls whose scene is there, or could not be loaded. */
void dispatch_scenes_ready(struct server *server);
/* A snapshot came back: answers its call. Frees the snapshot. */
void dispatch_picture(struct server *server, struct encode_job *job);
/* Forgets what a session that is gone still waits for. */
void dispatch_forget(struct server *server, uint64_t session);

/* Sends a notification; takes `params` over. */
void dispatch_notify(struct server *server, uint64_t session, const char *method, json_t *params);
/* {"code", "message", "data": {"field", "limit"}} */
json_t *dispatch_error_json(enum rpc_code code, const struct error *err);
enum rpc_code dispatch_code(const struct error *err);

/* For methods: the entry of `name` (NULL: the server's first scene), READY and with one reference; else OUTCOME_SCENE or OUTCOME_FAILED. */
enum outcome dispatch_scene(struct server *server, struct call *call, const char *name, struct scene_entry **out,
                            struct error *err);
