#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "net_state.h"

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
bool net_read_request(struct lws *wsi, struct request_text *text, struct net_request *out)
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

/* A WebSocket handshake that asks for no subprotocol lands here. */
static int refuse_upgrade(struct lws *wsi, int status)
{
    lws_return_http_status(wsi, (unsigned)status, NULL);
    return 1;
}

int net_filter_upgrade(struct net *net, struct lws *wsi, bool right_protocol)
{
    struct request_text text;
    struct net_request request = {.upgrade = true};
    unsigned tag = 0;
    if (!net_read_request(wsi, &text, &request))
        return refuse_upgrade(wsi, 400);
    int status = net->handlers->admit(net->handlers->context, &request, &tag);
    if (status == 0 && !right_protocol)
        status = 400;
    if (status != 0)
        return refuse_upgrade(wsi, status);
    lws_set_opaque_user_data(wsi, (void *)(uintptr_t)tag);
    return 0;
}
