#include "net.h"

#include <errno.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/log.h"
#include "net_state.h"

#define TX_PACKET_SIZE (1u << 20) /* with 0, a frame of 200 kB took 54 sends, and copies */

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
                                               .callback = net_on_http,
                                               .per_session_data_size = sizeof(struct peer),
                                               .rx_buffer_size = 65536,
                                               .tx_packet_size = TX_PACKET_SIZE};
    net->protocols[1] = net->protocols[0];
    net->protocols[1].name = subprotocol;
    net->protocols[1].callback = net_on_websocket;
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
