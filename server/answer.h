/* What goes out as JSON: answers, errors, notifications. Network thread. */
#pragma once

#include <stdint.h>

#include <jansson.h>

#include "call.h"
#include "protocol.h"

/* Sends a notification; takes `params` over. */
void rpc_notify(struct server *server, uint64_t session, const char *method, json_t *params);
/* Takes `result` over. A notification gets no answer. */
void rpc_answer(struct server *server, const struct call *call, json_t *result);
void rpc_answer_error(struct server *server, const struct call *call, enum rpc_code code, const struct error *err);

/* {"code", "message", "data": {"field", "limit"}} */
json_t *rpc_error_json(enum rpc_code code, const struct error *err);
enum rpc_code rpc_code_of(const struct error *err);
