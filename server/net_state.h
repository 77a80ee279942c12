/* What the files of the network thread share: net.c (the thread and its port), net_connection.c (who is connected), net_request.c (headers), net_http.c
 * and net_websocket.c. For those alone: no other file includes libwebsockets. */
#pragma once

#include <libwebsockets.h>
#include <stdatomic.h>

#include "base/array.h"
#include "net.h"

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

/* lws's callbacks of the two protocols. */
int net_on_http(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t length);
int net_on_websocket(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t length);

struct net *net_of(struct lws *wsi);
uint64_t net_id(const struct net *net, const struct connection *c);
struct connection *net_find(const struct net *net, uint64_t id); /* NULL when it is gone */
/* NULL when NET_CONNECTIONS are open. */
struct connection *net_connection_open(struct net *net, struct lws *wsi, bool websocket);
/* Drops what is queued and tells handlers.closed. Harmless when it is closed already. */
void net_connection_close(struct net *net, struct peer *peer);

/* Fills `out`, whose strings lie in `text`. False when a header is longer than any honest one. */
bool net_read_request(struct lws *wsi, struct request_text *text, struct net_request *out);
/* Whether a handshake may become a WebSocket: 0, or 1 after refusing it. */
int net_filter_upgrade(struct net *net, struct lws *wsi, bool right_protocol);
