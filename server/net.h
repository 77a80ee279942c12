/* The sockets: HTTP and WebSocket on one port. Only net.c and net_*.c include libwebsockets. All functions belong to the network
 * thread, the one in net_run(), except net_wake() and net_stop(). Connections are named by id, never by pointer; an id whose connection
 * is gone is ignored. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct net;
struct packet;

#define NET_CONNECTIONS 256        /* requests and WebSockets together */
#define NET_MESSAGE_MAX (1u << 20) /* bytes; a longer WebSocket message closes with 1009, a longer body gets 413 */
#define NET_BACKLOG_MAX (8u << 20) /* bytes of unsent text; a client past it is hung up */

enum net_method { NET_GET, NET_HEAD, NET_POST, NET_OPTIONS, NET_OTHER };

/* Absent headers are NULL. Valid during the call. */
struct net_request {
    enum net_method method;
    bool upgrade;     /* to a WebSocket of the right subprotocol */
    const char *path; /* decoded, without the query */
    const char *host, *origin;
    const char *token; /* Authorization: Bearer, else ?token= */
};

struct net_response {
    int status;
    const char *type;         /* content type, static */
    struct packet *body;      /* taken over; may be NULL */
    size_t offset;            /* of the body in the packet */
    const char *allow_origin; /* or NULL; copied */
    const char *headers[4];   /* more "name:", "value" pairs, static; NULL ends */
};

struct net_handlers {
    void *context;
    /* 0 to let it in, else the HTTP status to refuse with. *tag comes back with the connection. */
    int (*admit)(void *context, const struct net_request *request, unsigned *tag);
    /* A whole request: answer with net_respond(), now or later. The body ends with a zero byte that `size` does not count. */
    void (*request)(void *context, uint64_t id, unsigned tag, const struct net_request *request, const char *body, size_t size);
    void (*opened)(void *context, uint64_t id, unsigned tag);
    void (*message)(void *context, uint64_t id, const char *text, size_t size);
    /* The socket began or ceased to have pending writes. */
    void (*blocked)(void *context, uint64_t id, bool blocked);
    void (*closed)(void *context, uint64_t id); /* requests too, answered or not */
    void (*woken)(void *context);               /* after net_wake(); wakes may merge */
    void (*tick)(void *context);                /* each second */
};

/* `host`: an address, or localhost; `port` 0: any free one. `subprotocol` and `handlers` are borrowed. ERROR_IO when it cannot listen. */
struct net *net_create(const char *host, unsigned port, const char *subprotocol, const struct net_handlers *handlers,
                       struct error *err);
/* Closes every connection (handlers.closed is called). Accepts NULL. */
void net_destroy(struct net *net);
unsigned net_port(const struct net *net);

void net_run(struct net *net);  /* until net_stop() */
void net_stop(struct net *net); /* any thread */
void net_wake(struct net *net); /* any thread */

/* Queues a WebSocket message; takes one reference over, even when the connection is gone. False when it is. */
bool net_send(struct net *net, uint64_t id, struct packet *packet);
/* Bytes queued and not yet taken by the socket. */
size_t net_queued(const struct net *net, uint64_t id);
void net_respond(struct net *net, uint64_t id, const struct net_response *response);
/* Closes a WebSocket with `code` after what is queued. */
void net_close(struct net *net, uint64_t id, unsigned code, const char *reason);
