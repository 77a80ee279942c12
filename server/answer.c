#include "answer.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/log.h"
#include "http.h"
#include "output.h"
#include "server.h"

enum rpc_code rpc_code_of(const struct error *err)
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

json_t *rpc_error_json(enum rpc_code code, const struct error *err)
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

void rpc_notify(struct server *server, uint64_t session, const char *method, json_t *params)
{
    send_json(server, session, json_pack("{s:s, s:s, s:o}", "jsonrpc", "2.0", "method", method, "params", params));
}

void rpc_answer(struct server *server, const struct call *call, json_t *result)
{
    if (call->id)
        send_json(server, call->session, json_pack("{s:s, s:O, s:o}", "jsonrpc", "2.0", "id", call->id, "result", result));
    else
        json_decref(result);
}

/* "The Server MUST NOT reply to a Notification" (JSON-RPC 2.0, 4.1). */
void rpc_answer_error(struct server *server, const struct call *call, enum rpc_code code, const struct error *err)
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
              json_pack("{s:s, s:O, s:o}", "jsonrpc", "2.0", "id", call->id, "error", rpc_error_json(code, err)));
}
