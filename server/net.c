#include "net.h"

#include <assert.h>
#include <errno.h>
#include <libwebsockets.h>
#include <netdb.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/log.h"
#include "frame_packet.h"

static_assert(PACKET_HEADROOM >= LWS_PRE, "lws_write() puts its frame header in front of the data");

#define BODY_CHUNK      (256u * 1024)
#define TX_PACKET_SIZE  (1u << 20) /* with 0, a frame of 200 kB took 54 sends, and copies */
/* A body too long is read past up to here, so that its sender sees the answer and not a reset connection. */
#define DISCARD_MAX     (64ull << 20)
#define CLOSE_TIMEOUT_S 5

/* What lws forgets once the headers are parsed. */
struct request_text {
    char path[1024], host[256], origin[256], token[320];
};

struct connection {
    uint32_t generation;
    bool used, websocket, blocked;
    struct lws *wsi;
    unsigned tag;
    ARRAY(char) inbox; /* the message or body so far */

    /* WebSocket */
    ARRAY(struct packet *) outbox; /* `sent` of them are gone */
    size_t sent, queued_bytes;
    unsigned close_code;
    char close_reason[120];

    /* HTTP */
    struct net_request request;
    struct request_text text;
    int refused; /* status, once the body has been read past */
    bool responded, headers_sent;
    struct net_response response;
    char allow_origin[256];
    size_t body_sent;
};

struct net {
    struct lws_context *context;
    struct lws_protocols protocols[3];
    const struct net_handlers *handlers;
    lws_sorted_usec_list_t ticker;
    atomic_bool stopping;
    unsigned port;
    struct connection connections[NET_CONNECTIONS];
};

/* lws's per-connection memory. */
struct peer {
    uint64_t id; /* 0: none */
};

static uint64_t id_of(const struct net *net, const struct connection *c)
{
    return (uint64_t)c->generation << 32 | (uint64_t)(c - net->connections);
}

static struct connection *find(const struct net *net, uint64_t id)
{
    uint32_t index = (uint32_t)id;
    if (index >= NET_CONNECTIONS)
        return NULL;
    const struct connection *c = &net->connections[index];
    return c->used && c->generation == id >> 32 ? (struct connection *)c : NULL;
}

static struct connection *open_connection(struct net *net, struct lws *wsi, bool websocket)
{
    for (size_t i = 0; i < NET_CONNECTIONS; i++) {
        struct connection *c = &net->connections[i];
        if (c->used)
            continue;
        uint32_t generation = c->generation + 1 ? c->generation + 1 : 1;
        *c = (struct connection){.generation = generation, .used = true, .websocket = websocket, .wsi = wsi};
        return c;
    }
    return NULL;
}

static void close_connection(struct net *net, struct peer *peer)
{
    struct connection *c = peer ? find(net, peer->id) : NULL;
    if (!c)
        return;
    uint64_t id = peer->id;
    peer->id = 0;
    while (c->sent < c->outbox.count)
        packet_unref(c->outbox.data[c->sent++]);
    packet_unref(c->response.body);
    array_finish(&c->outbox);
    array_finish(&c->inbox);
    c->used = false;
    net->handlers->closed(net->handlers->context, id);
}

static bool header(struct lws *wsi, enum lws_token_indexes token, char *out, size_t size, const char **field)
{
    *field = NULL;
    if (lws_hdr_total_length(wsi, token) <= 0)
        return true;
    if (lws_hdr_copy(wsi, out, (int)size, token) < 0)
        return false;
    *field = out;
    return true;
}

static enum net_method method_of(struct lws *wsi)
{
    char *uri;
    int length;
    switch (lws_http_get_uri_and_method(wsi, &uri, &length)) {
    case LWSHUMETH_GET: return NET_GET;
    case LWSHUMETH_HEAD: return NET_HEAD;
    case LWSHUMETH_POST: return NET_POST;
    case LWSHUMETH_OPTIONS: return NET_OPTIONS;
    default: return NET_OTHER;
    }
}

static void read_token(struct lws *wsi, struct request_text *text, struct net_request *out)
{
    static const char bearer[] = "Bearer ";
    char value[sizeof text->token];
    out->token = text->token;
    if (lws_hdr_copy(wsi, value, sizeof value, WSI_TOKEN_HTTP_AUTHORIZATION) > 0) {
        bool is_bearer = strncasecmp(value, bearer, sizeof bearer - 1) == 0;
        snprintf(text->token, sizeof text->token, "%s", is_bearer ? value + sizeof bearer - 1 : "");
        return;
    }
    const char *argument = lws_get_urlarg_by_name(wsi, "token=", value, sizeof value);
    if (argument)
        snprintf(text->token, sizeof text->token, "%s", argument);
    else
        out->token = NULL;
}

/* False when a header is longer than any honest one. */
static bool read_request(struct lws *wsi, struct request_text *text, struct net_request *out)
{
    char *uri;
    int length;
    out->method = method_of(wsi);
    if (lws_http_get_uri_and_method(wsi, &uri, &length) < 0 || (size_t)length >= sizeof text->path)
        return false;
    memcpy(text->path, uri, (size_t)length);
    text->path[length] = 0;
    out->path = text->path;
    read_token(wsi, text, out);
    return header(wsi, WSI_TOKEN_HOST, text->host, sizeof text->host, &out->host) &&
           header(wsi, WSI_TOKEN_ORIGIN, text->origin, sizeof text->origin, &out->origin);
}

/* ---- HTTP ---- */

static const char *reason_phrase(int status)
{
    switch (status) {
    case 400: return "bad request\n";
    case 401: return "a token is needed: Authorization: Bearer TOKEN, or ?token=TOKEN\n";
    case 403: return "this Host or Origin may not talk to this server\n";
    case 404: return "not found\n";
    case 405: return "this method is not known here\n";
    case 411: return "Content-Length is needed\n";
    case 413: return "the body is too long\n";
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
    net_respond(net, id_of(net, c), &response);
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
    net->handlers->request(net->handlers->context, id_of(net, c), c->tag, &c->request, c->inbox.data, c->inbox.count - 1);
}

static int http_begin(struct net *net, struct peer *peer, struct lws *wsi)
{
    struct connection *c = open_connection(net, wsi, false);
    if (!c)
        return lws_return_http_status(wsi, HTTP_STATUS_SERVICE_UNAVAILABLE, NULL), -1;
    peer->id = id_of(net, c);
    if (!read_request(wsi, &c->text, &c->request))
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
    close_connection(net, peer);
    return lws_http_transaction_completed(wsi) || unread ? -1 : 0;
}

static int http_writable(struct net *net, struct peer *peer)
{
    struct connection *c = find(net, peer->id);
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

static struct net *net_of(struct lws *wsi) { return lws_context_user(lws_get_context(wsi)); }

/* A WebSocket handshake that asks for no subprotocol lands here. */
static int refuse_upgrade(struct lws *wsi, int status)
{
    lws_return_http_status(wsi, (unsigned)status, NULL);
    return 1;
}

static int filter_upgrade(struct net *net, struct lws *wsi, bool right_protocol)
{
    struct request_text text;
    struct net_request request = {.upgrade = true};
    unsigned tag = 0;
    if (!read_request(wsi, &text, &request))
        return refuse_upgrade(wsi, 400);
    int status = net->handlers->admit(net->handlers->context, &request, &tag);
    if (status == 0 && !right_protocol)
        status = 400;
    if (status != 0)
        return refuse_upgrade(wsi, status);
    lws_set_opaque_user_data(wsi, (void *)(uintptr_t)tag);
    return 0;
}

static int on_http(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t length)
{
    struct net *net = net_of(wsi);
    struct peer *peer = user;
    struct connection *c;
    switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: return filter_upgrade(net, wsi, false);
    case LWS_CALLBACK_HTTP: return http_begin(net, peer, wsi);
    case LWS_CALLBACK_HTTP_BODY:
        if ((c = find(net, peer->id)))
            http_body(c, in, length);
        return 0;
    case LWS_CALLBACK_HTTP_BODY_COMPLETION:
        if ((c = find(net, peer->id)) && !c->responded)
            deliver_request(net, c);
        return 0;
    case LWS_CALLBACK_HTTP_WRITEABLE: return http_writable(net, peer);
    case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
    case LWS_CALLBACK_CLOSED_HTTP: close_connection(net, peer); return 0;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED: net->handlers->woken(net->handlers->context); return 0;
    default: return 0;
    }
}

void net_respond(struct net *net, uint64_t id, const struct net_response *response)
{
    struct connection *c = find(net, id);
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

/* ---- WebSocket ---- */

static void set_blocked(struct net *net, struct connection *c, bool blocked)
{
    if (c->blocked == blocked)
        return;
    c->blocked = blocked;
    net->handlers->blocked(net->handlers->context, id_of(net, c), blocked);
}

static int close_with(struct lws *wsi, unsigned code, const char *reason)
{
    lws_close_reason(wsi, (enum lws_close_status)code, (unsigned char *)reason, strlen(reason));
    return -1;
}

static int ws_established(struct net *net, struct peer *peer, struct lws *wsi)
{
    struct connection *c = open_connection(net, wsi, true);
    if (!c)
        return close_with(wsi, 1013, "too many connections");
    c->tag = (unsigned)(uintptr_t)lws_get_opaque_user_data(wsi);
    peer->id = id_of(net, c);
    net->handlers->opened(net->handlers->context, peer->id, c->tag);
    return 0;
}

static int ws_receive(struct net *net, struct peer *peer, struct lws *wsi, const void *in, size_t length)
{
    struct connection *c = find(net, peer->id);
    if (!c)
        return -1;
    if (lws_frame_is_binary(wsi))
        return close_with(wsi, 1003, "messages are JSON text");
    if (lws_is_first_fragment(wsi))
        c->inbox.count = 0;
    size_t at = c->inbox.count;
    if (at + length > NET_MESSAGE_MAX)
        return close_with(wsi, 1009, "a message may have 1 MiB");
    if (!array_extend(&c->inbox, length))
        return close_with(wsi, 1011, "out of memory");
    if (length > 0)
        memcpy(c->inbox.data + at, in, length);
    if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi) > 0)
        return 0;
    net->handlers->message(net->handlers->context, peer->id, c->inbox.data ? c->inbox.data : "", c->inbox.count);
    if (c->inbox.capacity > 65536)
        array_finish(&c->inbox);
    return 0;
}

static int ws_writable(struct net *net, struct peer *peer, struct lws *wsi)
{
    struct connection *c = find(net, peer->id);
    if (!c)
        return -1;
    if (lws_partial_buffered(wsi)) {
        lws_callback_on_writable(wsi);
        return 0;
    }
    if (c->sent == c->outbox.count) {
        c->sent = c->outbox.count = 0;
        if (c->close_code)
            return close_with(wsi, c->close_code, c->close_reason);
        set_blocked(net, c, false);
        return 0;
    }
    struct packet *packet = c->outbox.data[c->sent++];
    c->queued_bytes -= packet->size;
    int written = lws_write(wsi, packet->data, packet->size, packet->binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT);
    packet_unref(packet);
    if (written < 0)
        return -1;
    /* Once more, to learn when what lws keeps has gone out, too. */
    if (c->sent < c->outbox.count || c->close_code || lws_partial_buffered(wsi))
        lws_callback_on_writable(wsi);
    else
        set_blocked(net, c, false);
    return 0;
}

static int on_websocket(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t length)
{
    struct net *net = net_of(wsi);
    switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: return filter_upgrade(net, wsi, true);
    case LWS_CALLBACK_ESTABLISHED: return ws_established(net, user, wsi);
    case LWS_CALLBACK_RECEIVE: return ws_receive(net, user, wsi, in, length);
    case LWS_CALLBACK_SERVER_WRITEABLE: return ws_writable(net, user, wsi);
    case LWS_CALLBACK_CLOSED: close_connection(net, user); return 0;
    default: return 0;
    }
}

static void forget_sent(struct connection *c)
{
    if (c->sent == 0)
        return;
    c->outbox.count -= c->sent;
    memmove(c->outbox.data, c->outbox.data + c->sent, c->outbox.count * sizeof c->outbox.data[0]);
    c->sent = 0;
}

static void hang_up(struct connection *c) { lws_set_timeout(c->wsi, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC); }

bool net_send(struct net *net, uint64_t id, struct packet *packet)
{
    struct connection *c = find(net, id);
    if (!c || !c->websocket || c->close_code) {
        packet_unref(packet);
        return false;
    }
    forget_sent(c);
    /* Frames are bounded by credit, answers only by this. */
    bool too_much = !packet->binary && c->queued_bytes + packet->size > NET_BACKLOG_MAX;
    if (too_much || !array_push(&c->outbox, packet)) {
        log_warning("a client does not read what it asked for: hung up");
        packet_unref(packet);
        hang_up(c);
        return false;
    }
    c->queued_bytes += packet->size;
    if (packet->binary)
        set_blocked(net, c, true);
    lws_callback_on_writable(c->wsi);
    return true;
}

size_t net_queued(const struct net *net, uint64_t id)
{
    const struct connection *c = find(net, id);
    return c ? c->queued_bytes : 0;
}

void net_close(struct net *net, uint64_t id, unsigned code, const char *reason)
{
    struct connection *c = find(net, id);
    if (!c || !c->websocket || c->close_code)
        return;
    c->close_code = code;
    snprintf(c->close_reason, sizeof c->close_reason, "%s", reason);
    lws_set_timeout(c->wsi, PENDING_TIMEOUT_USER_OK, CLOSE_TIMEOUT_S);
    lws_callback_on_writable(c->wsi);
}

/* ---- the thread ---- */

static void log_line(int level, const char *line)
{
    int length = (int)strcspn(line, "\n");
    log_write(level & LLL_ERR ? LOG_WARNING : LOG_DEBUG, "lws: %.*s", length, line);
}

static void on_tick(lws_sorted_usec_list_t *ticker)
{
    struct net *net = lws_container_of(ticker, struct net, ticker);
    net->handlers->tick(net->handlers->context);
    lws_sul_schedule(net->context, 0, &net->ticker, on_tick, LWS_US_PER_SEC);
}

/* Binds once beforehand: lws would say only that it could not. */
static bool probe(const char *host, unsigned port, struct error *err)
{
    char service[8];
    snprintf(service, sizeof service, "%u", port);
    struct addrinfo hints = {.ai_flags = AI_NUMERICHOST | AI_PASSIVE, .ai_socktype = SOCK_STREAM}, *address = NULL;
    if (getaddrinfo(host, service, &hints, &address) != 0)
        return error_set(err, ERROR_USAGE, "--listen",
                         "--listen: %s is not an address of this machine; an IP address or localhost is accepted", host);
    int one = 1, s = socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    bool ok = s >= 0 && setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one) == 0 &&
              bind(s, address->ai_addr, address->ai_addrlen) == 0 && listen(s, 1) == 0;
    if (!ok)
        error_set(err, ERROR_IO, "--listen",
                  "--listen %s:%u: %s; a free address and port of this machine is wanted, port 0 picks one", host, port,
                  strerror(errno));
    if (s >= 0)
        close(s);
    freeaddrinfo(address);
    return ok;
}

static struct lws_context *make_context(struct net *net, const char *host, unsigned port, const char *subprotocol)
{
    /* 10 s to the ping, 30 s to the hang-up; lws's default is 5 minutes. */
    static const lws_retry_bo_t idle_policy = {.secs_since_valid_ping = 10, .secs_since_valid_hangup = 30};
    net->protocols[0] = (struct lws_protocols){.name = "http",
                                               .callback = on_http,
                                               .per_session_data_size = sizeof(struct peer),
                                               .rx_buffer_size = 65536,
                                               .tx_packet_size = TX_PACKET_SIZE};
    net->protocols[1] = net->protocols[0];
    net->protocols[1].name = subprotocol;
    net->protocols[1].callback = on_websocket;
    bool any = strcmp(host, "0.0.0.0") == 0 || strcmp(host, "::") == 0;
    struct lws_context_creation_info info = {
        .port = (int)port,
        .iface = any ? NULL : host,
        .protocols = net->protocols,
        .options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_VALIDATE_UTF8 |
                   (strchr(host, ':') ? 0 : LWS_SERVER_OPTION_DISABLE_IPV6),
        .user = net,
        .gid = -1,
        .uid = -1,
        .retry_and_idle_policy = &idle_policy,
        .keepalive_timeout = 30,
        .server_string = "gnomon",
    };
    return lws_create_context(&info);
}

struct net *net_create(const char *host, unsigned port, const char *subprotocol, const struct net_handlers *handlers,
                       struct error *err)
{
    if (strcmp(host, "localhost") == 0)
        host = "127.0.0.1";
    if (!probe(host, port, err))
        return NULL;
    struct net *net = calloc(1, sizeof *net);
    if (!net) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the network thread");
        return NULL;
    }
    net->handlers = handlers;
    lws_set_log_level(LLL_ERR | LLL_WARN, log_line);
    net->context = make_context(net, host, port, subprotocol);
    struct lws_vhost *vhost = net->context ? lws_get_vhost_by_name(net->context, "default") : NULL;
    if (!vhost || lws_get_vhost_listen_port(vhost) <= 0) {
        error_set(err, ERROR_IO, "--listen",
                  "--listen %s:%u: cannot listen there; a free address and port of this machine is wanted", host, port);
        net_destroy(net);
        return NULL;
    }
    net->port = (unsigned)lws_get_vhost_listen_port(vhost);
    lws_sul_schedule(net->context, 0, &net->ticker, on_tick, LWS_US_PER_SEC);
    return net;
}

void net_destroy(struct net *net)
{
    if (!net)
        return;
    if (net->context)
        lws_context_destroy(net->context);
    free(net);
}

unsigned net_port(const struct net *net) { return net->port; }

void net_run(struct net *net)
{
    while (!atomic_load(&net->stopping) && lws_service(net->context, 0) >= 0)
        ;
}

void net_stop(struct net *net)
{
    atomic_store(&net->stopping, true);
    lws_cancel_service(net->context);
}

void net_wake(struct net *net) { lws_cancel_service(net->context); }
