#include "frame_packet.h"
#include "net_state.h"

struct net *net_of(struct lws *wsi) { return lws_context_user(lws_get_context(wsi)); }

uint64_t net_id(const struct net *net, const struct connection *c)
{
    return (uint64_t)c->generation << 32 | (uint64_t)(c - net->connections);
}

struct connection *net_find(const struct net *net, uint64_t id)
{
    uint32_t index = (uint32_t)id;
    if (index >= NET_CONNECTIONS)
        return NULL;
    const struct connection *c = &net->connections[index];
    return c->used && c->generation == id >> 32 ? (struct connection *)c : NULL;
}

struct connection *net_connection_open(struct net *net, struct lws *wsi, bool websocket)
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

void net_connection_close(struct net *net, struct peer *peer)
{
    struct connection *c = peer ? net_find(net, peer->id) : NULL;
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
