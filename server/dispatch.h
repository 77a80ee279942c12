/* JSON-RPC 2.0: the methods of the generated table, one way in for text messages and for POST /v1/render. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "call.h"
#include "protocol.h"

struct error;
struct scene_entry;
struct server;

/* NULL when there is none. */
const struct method *method_find(const char *name);

/* One text message of a session. */
void dispatch_message(struct server *server, uint64_t session, const char *text, size_t size);
/* The body of POST /v1/render. */
void dispatch_render(struct server *server, uint64_t request, const char *allow_origin, const char *text, size_t size);

/* Runs a call and answers it, or keeps it for later. Takes it over. */
void dispatch_run(struct server *server, struct call *call);

/* For methods: the entry of `name` (NULL: the server's first scene), READY and with one reference; else OUTCOME_SCENE or OUTCOME_FAILED. */
enum outcome dispatch_scene(struct server *server, struct call *call, const char *name, struct scene_entry **out,
                            struct error *err);
