/* Requests that are not answered yet: they wait for a scene, a picture or a comparison. Network thread. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include "call.h"

struct encode_job;

#define PENDING_MAX 64 /* of one session */

/* Keeps a call that returned OUTCOME_SCENE or OUTCOME_LATER, and tells its client what it waits for. */
void pending_add(struct server *server, struct call *call);
size_t pending_count(const struct server *server, uint64_t session);
void call_free(struct call *call);

/* Runs the calls whose scene is there, or could not be loaded. */
void pending_scenes_ready(struct server *server);
/* A request came back from the render thread: answers its call. Frees the request. */
void pending_answer(struct server *server, struct encode_job *job);
/* $/progress for those that have come further. */
void pending_tell(struct server *server);
/* Answers the call `id` with RPC_CANCELLED. False when there is none. */
bool pending_cancel(struct server *server, uint64_t session, const json_t *id);
/* Forgets what a session that is gone still waits for. */
void pending_forget(struct server *server, uint64_t session);
