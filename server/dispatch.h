/* JSON-RPC 2.0: the methods of the generated table, one way in for text messages and for POST /v1/render, one way out for answers. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "call.h"
#include "protocol.h"

struct error;
struct encode_job;
struct scene_entry;
struct server;

/* NULL when there is none. */
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
