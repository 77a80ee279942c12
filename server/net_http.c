#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "frame_packet.h"
#include "net_state.h"

#define BODY_CHUNK  (256u * 1024)
/* A body too long is read past up to here, so that its sender sees the answer and not a reset connection. */
#define DISCARD_MAX (64ull << 20)

static const char *reason_phrase(int status)
{
    switch (status) {
    case 400: return "bad request\n";
    case 401: return "a token is needed: Authorization: Bearer TOKEN, or ?token=TOKEN\n";
    case 403: return "this Host or Origin may not talk to this server\n";
    case 404: return "not found\n";
    case 405: return "this method is not known here\n";
    case 411: return "a Content-Length is needed; chunked bodies are not accepted\n";
    case 413: return "the body is too long; at most 1 MiB is accepted\n";
    default: return "refused\n";
    }
}

static void refuse(struct net *net, struct connection *c, int status)
{
    static const char challenge[] = "Bearer realm=\"gnomon\"";
    const char *text = reason_phrase(status);
    struct net_response response = {
        .status = status, .type = "text/plain; charset=utf-8", .body = packet_from_text(text, strlen(text))};
    if (status == 401) {
        response.headers[0] = "www-authenticate:";
        response.headers[1] = challenge;
    }
    net_respond(net, net_id(net, c), &response);
}

static void deliver_request(struct net *net, struct connection *c)
{
    /* The answer may take a while: lws must not time the connection out. */
    lws_set_timeout(c->wsi, NO_PENDING_TIMEOUT, 0);
    if (c->refused) {
        refuse(net, c, c->refused);
        return;
    }
    if (!array_push(&c->inbox, 0)) {
        refuse(net, c, 503);
        return;
    }
    net->handlers->request(net->handlers->context, net_id(net, c), c->tag, &c->request, c->inbox.data, c->inbox.count - 1);
}

static int http_begin(struct net *net, struct peer *peer, struct lws *wsi)
{
    struct connection *c = net_connection_open(net, wsi, false);
    if (!c)
        return lws_return_http_status(wsi, HTTP_STATUS_SERVICE_UNAVAILABLE, NULL), -1;
    peer->id = net_id(net, c);
    if (!net_read_request(wsi, &c->text, &c->request))
        c->refused = 400;
    else
        c->refused = net->handlers->admit(net->handlers->context, &c->request, &c->tag);
    if (!c->refused && c->request.method == NET_OTHER)
        c->refused = 405;
    if (c->request.method != NET_POST) {
        deliver_request(net, c);
        return 0;
    }
    char length[24] = "";
    if (lws_hdr_copy(wsi, length, sizeof length, WSI_TOKEN_HTTP_CONTENT_LENGTH) <= 0) {
        refuse(net, c, lws_hdr_total_length(wsi, WSI_TOKEN_HTTP_CONTENT_LENGTH) > 0 ? 413 : 411);
        return 0;
    }
    unsigned long long announced = strtoull(length, NULL, 10);
    if (announced > DISCARD_MAX)
        refuse(net, c, 413);
    else if (announced > NET_MESSAGE_MAX)
        c->refused = c->refused ? c->refused : 413;
    else if (announced == 0)
        deliver_request(net, c);
    return 0;
}

static void http_body(struct connection *c, const void *in, size_t length)
{
    if (c->responded || c->refused)
        return;
    size_t at = c->inbox.count;
    if (at + length > NET_MESSAGE_MAX || !array_extend(&c->inbox, length))
        c->refused = 413;
    else
        memcpy(c->inbox.data + at, in, length);
}

static bool add_header(struct lws *wsi, const char *name, const char *value, unsigned char **p, unsigned char *end)
{
    return lws_add_http_header_by_name(wsi, (const unsigned char *)name, (const unsigned char *)value, (int)strlen(value), p,
                                       end) == 0;
}

static size_t body_size(const struct connection *c) { return c->response.body ? c->response.body->size - c->response.offset : 0; }

/* A body that was not read would be taken for the next request. */
static bool must_close(const struct connection *c)
{
    return c->request.method == NET_OTHER || c->response.status == 411 || (c->response.status == 413 && !c->refused);
}

static bool send_headers(struct connection *c)
{
    unsigned char buffer[LWS_PRE + 4096], *p = buffer + LWS_PRE, *end = buffer + sizeof buffer - 1;
    const struct net_response *r = &c->response;
    bool ok = lws_add_http_common_headers(c->wsi, (unsigned)r->status, r->type, body_size(c), &p, end) == 0 &&
              add_header(c->wsi, "cache-control:", "no-store", &p, end) &&
              add_header(c->wsi, "x-content-type-options:", "nosniff", &p, end) &&
              add_header(c->wsi, "referrer-policy:", "no-referrer", &p, end);
    if (ok && r->allow_origin)
        ok = add_header(c->wsi, "access-control-allow-origin:", r->allow_origin, &p, end) &&
             add_header(c->wsi, "vary:", "Origin", &p, end);
    for (size_t i = 0; ok && i + 1 < sizeof r->headers / sizeof r->headers[0] && r->headers[i]; i += 2)
        ok = add_header(c->wsi, r->headers[i], r->headers[i + 1], &p, end);
    if (ok && must_close(c))
        ok = add_header(c->wsi, "connection:", "close", &p, end);
    return ok && lws_finalize_write_http_header(c->wsi, buffer + LWS_PRE, &p, end) == 0;
}

static int http_finish(struct net *net, struct peer *peer, struct connection *c)
{
    struct lws *wsi = c->wsi;
    bool unread = must_close(c);
    net_connection_close(net, peer);
    return lws_http_transaction_completed(wsi) || unread ? -1 : 0;
}

static int http_writable(struct net *net, struct peer *peer)
{
    struct connection *c = net_find(net, peer->id);
    if (!c || !c->responded)
        return 0;
    if (!c->headers_sent) {
        if (!send_headers(c))
            return -1;
        c->headers_sent = true;
        if (body_size(c) == 0 || c->request.method == NET_HEAD)
            return http_finish(net, peer, c);
        lws_callback_on_writable(c->wsi);
        return 0;
    }
    size_t left = body_size(c) - c->body_sent;
    size_t n = left < BODY_CHUNK ? left : BODY_CHUNK;
    unsigned char *data = c->response.body->data + c->response.offset + c->body_sent;
    if (lws_write(c->wsi, data, n, n == left ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < (int)n)
        return -1;
    c->body_sent += n;
    if (n == left)
        return http_finish(net, peer, c);
    lws_callback_on_writable(c->wsi);
    return 0;
}

int net_on_http(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t length)
{
    struct net *net = net_of(wsi);
    struct peer *peer = user;
    struct connection *c;
    switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: return net_filter_upgrade(net, wsi, false);
    case LWS_CALLBACK_HTTP: return http_begin(net, peer, wsi);
    case LWS_CALLBACK_HTTP_BODY:
        if ((c = net_find(net, peer->id)))
            http_body(c, in, length);
        return 0;
    case LWS_CALLBACK_HTTP_BODY_COMPLETION:
        if ((c = net_find(net, peer->id)) && !c->responded)
            deliver_request(net, c);
        return 0;
    case LWS_CALLBACK_HTTP_WRITEABLE: return http_writable(net, peer);
    case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
    case LWS_CALLBACK_CLOSED_HTTP: net_connection_close(net, peer); return 0;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED: net->handlers->woken(net->handlers->context); return 0;
    default: return 0;
    }
}

void net_respond(struct net *net, uint64_t id, const struct net_response *response)
{
    struct connection *c = net_find(net, id);
    if (!c || c->websocket || c->responded) {
        packet_unref(response->body);
        return;
    }
    c->response = *response;
    c->responded = true;
    if (response->allow_origin) {
        snprintf(c->allow_origin, sizeof c->allow_origin, "%s", response->allow_origin);
        c->response.allow_origin = c->allow_origin;
    }
    lws_callback_on_writable(c->wsi);
}
