#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "frame_packet.h"
#include "net_state.h"

static_assert(PACKET_HEADROOM >= LWS_PRE, "lws_write() puts its frame header in front of the data");

#define CLOSE_TIMEOUT_S 5

static void set_blocked(struct net *net, struct connection *c, bool blocked)
{
    if (c->blocked == blocked)
        return;
    c->blocked = blocked;
    net->handlers->blocked(net->handlers->context, net_id(net, c), blocked);
}

static int close_with(struct lws *wsi, unsigned code, const char *reason)
{
    lws_close_reason(wsi, (enum lws_close_status)code, (unsigned char *)reason, strlen(reason));
    return -1;
}

static int ws_established(struct net *net, struct peer *peer, struct lws *wsi)
{
    struct connection *c = net_connection_open(net, wsi, true);
    if (!c)
        return close_with(wsi, 1013, "too many connections");
    c->tag = (unsigned)(uintptr_t)lws_get_opaque_user_data(wsi);
    peer->id = net_id(net, c);
    net->handlers->opened(net->handlers->context, peer->id, c->tag);
    return 0;
}

static int ws_receive(struct net *net, struct peer *peer, struct lws *wsi, const void *in, size_t length)
{
    struct connection *c = net_find(net, peer->id);
    if (!c)
        return -1;
    lws_validity_confirmed(wsi); /* who writes lives, though it may not read, nor answer pings, for a while */
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
    struct connection *c = net_find(net, peer->id);
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

int net_on_websocket(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t length)
{
    struct net *net = net_of(wsi);
    switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: return net_filter_upgrade(net, wsi, true);
    case LWS_CALLBACK_ESTABLISHED: return ws_established(net, user, wsi);
    case LWS_CALLBACK_RECEIVE: return ws_receive(net, user, wsi, in, length);
    case LWS_CALLBACK_SERVER_WRITEABLE: return ws_writable(net, user, wsi);
    case LWS_CALLBACK_CLOSED: net_connection_close(net, user); return 0;
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
    struct connection *c = net_find(net, id);
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
    const struct connection *c = net_find(net, id);
    return c ? c->queued_bytes : 0;
}

void net_close(struct net *net, uint64_t id, unsigned code, const char *reason)
{
    struct connection *c = net_find(net, id);
    if (!c || !c->websocket || c->close_code)
        return;
    c->close_code = code;
    snprintf(c->close_reason, sizeof c->close_reason, "%s", reason);
    lws_set_timeout(c->wsi, PENDING_TIMEOUT_USER_OK, CLOSE_TIMEOUT_S);
    lws_callback_on_writable(c->wsi);
}
