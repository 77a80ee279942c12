#include "http.h"

#include <stdlib.h>
#include <string.h>

#include "answer.h"
#include "base/embed.h"
#include "base/error.h"
#include "listings.h"
#include "methods/methods.h"
#include "server.h"

#define TEXT "text/plain; charset=utf-8"

/* The page loads nothing but what we serve; frames are drawn from memory. */
#define PAGE_POLICY                                                                                                                       \
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self' ws: wss:; base-uri 'none'; " \
    "form-action 'none'; frame-ancestors 'none'"

struct route {
    enum net_method method;
    const char *path;
    void (*answer)(struct server *server, uint64_t id, const struct net_request *request, const char *body, size_t size);
    bool open; /* needs no token */
};

static const char *allowed_origin(const struct server *server, const struct net_request *request)
{
    return request->origin && access_origin_allowed(&server->access, request->origin) ? request->origin : NULL;
}

static void answer_text(struct server *server, uint64_t id, const struct net_request *request, int status, const char *type,
                        const char *text, size_t size)
{
    struct net_response response = {
        .status = status, .type = type, .body = packet_from_text(text, size), .allow_origin = allowed_origin(server, request)};
    net_respond(server->net, id, &response);
}

static void answer_health(struct server *server, uint64_t id, const struct net_request *request, const char *body, size_t size)
{
    (void)body, (void)size;
    answer_text(server, id, request, 200, TEXT, "ok\n", 3);
}

static void answer_ready(struct server *server, uint64_t id, const struct net_request *request, const char *body, size_t size)
{
    (void)body, (void)size;
    bool ready = !atomic_load(&server->device_lost);
    const char *text = ready ? "ready\n" : "the device is lost\n";
    answer_text(server, id, request, ready ? 200 : 503, TEXT, text, strlen(text));
}

static void answer_metrics(struct server *server, uint64_t id, const struct net_request *request, const char *body, size_t size)
{
    size_t length = 0;
    char *text = metrics_format(&server->metrics, &length);
    (void)body, (void)size;
    answer_text(server, id, request, text ? 200 : 503, "text/plain; version=0.0.4; charset=utf-8", text ? text : "", length);
    free(text);
}

/* {version, NAME: [...]}, as `gnomon list NAME --json` writes it. */
static void answer_list(struct server *server, uint64_t id, const struct net_request *request, const char *name, json_t *list)
{
    json_t *root = json_pack("{s:s, s:o}", "version", GNOMON_VERSION, name, list);
    char *text = root ? json_dumps(root, JSON_COMPACT) : NULL;
    answer_text(server, id, request, text ? 200 : 503, "application/json", text ? text : "{}", text ? strlen(text) : 2);
    free(text);
    json_decref(root);
}

static void answer_scenes(struct server *server, uint64_t id, const struct net_request *request, const char *body, size_t size)
{
    (void)body, (void)size;
    answer_list(server, id, request, "scenes", hello_scenes(server));
}

static void answer_algorithms(struct server *server, uint64_t id, const struct net_request *request, const char *body,
                              size_t size)
{
    (void)body, (void)size;
    answer_list(server, id, request, "algorithms", listing_algorithms());
}

/* The one that it renders on: a client has no choice of others. */
static void answer_devices(struct server *server, uint64_t id, const struct net_request *request, const char *body, size_t size)
{
    (void)body, (void)size;
    answer_list(server, id, request, "devices", listing_devices(render_loop_device(server->loop), 1));
}

static void answer_render(struct server *server, uint64_t id, const struct net_request *request, const char *body, size_t size)
{
    dispatch_render(server, id, allowed_origin(server, request), body, size);
}

static void answer_options(struct server *server, uint64_t id, const struct net_request *request)
{
    struct net_response response = {.status = 204,
                                    .type = TEXT,
                                    .allow_origin = allowed_origin(server, request),
                                    .headers = {"access-control-allow-methods:", "GET, POST",
                                                "access-control-allow-headers:", "authorization, content-type"}};
    net_respond(server->net, id, &response);
}

static const struct route routes[] = {
    {NET_GET, "/healthz", answer_health, true},
    {NET_GET, "/readyz", answer_ready, true},
    {NET_GET, "/metrics", answer_metrics, false},
    {NET_GET, "/v1/scenes", answer_scenes, false},
    {NET_GET, "/v1/algorithms", answer_algorithms, false},
    {NET_GET, "/v1/devices", answer_devices, false},
    {NET_POST, "/v1/render", answer_render, false},
};

static const char *page_type(const char *name)
{
    const char *dot = strrchr(name, '.');
    if (!dot)
        return "application/octet-stream";
    return strcmp(dot, ".html") == 0  ? "text/html; charset=utf-8"
           : strcmp(dot, ".js") == 0  ? "text/javascript; charset=utf-8"
           : strcmp(dot, ".css") == 0 ? "text/css; charset=utf-8"
           : strcmp(dot, ".svg") == 0 ? "image/svg+xml"
                                      : "application/octet-stream";
}

static const struct embedded_file *find_page(const char *path)
{
    const char *name = strcmp(path, "/") == 0 ? "index.html" : path + (path[0] == '/');
    for (const struct embedded_file *file = embedded_web; file->name; file++)
        if (strcmp(file->name, name) == 0)
            return file;
    return NULL;
}

static void answer_page(struct server *server, uint64_t id, const struct embedded_file *file)
{
    struct net_response response = {.status = 200,
                                    .type = page_type(file->name),
                                    .body = packet_from_text(file->data, (size_t)(file->end - file->data - 1)),
                                    .headers = {"content-security-policy:", PAGE_POLICY}};
    net_respond(server->net, id, &response);
}

static const struct route *find_route(const char *path)
{
    for (size_t i = 0; i < sizeof routes / sizeof routes[0]; i++)
        if (strcmp(routes[i].path, path) == 0)
            return &routes[i];
    return NULL;
}

/* Health probes carry no token. Scripts and styles of the page are no secret, and cannot carry the page's ?token=. */
static bool needs_token(const struct net_request *request)
{
    const struct route *route = find_route(request->path);
    if (request->method == NET_OPTIONS || (route && route->open))
        return false;
    return request->upgrade || strcmp(request->path, "/") == 0 || strcmp(request->path, "/index.html") == 0 ||
           !find_page(request->path);
}

int http_admit(void *context, const struct net_request *request, unsigned *tag)
{
    const struct server *server = context;
    if (!access_host_ok(&server->access, request->host) || !access_origin_ok(&server->access, request->origin, request->host))
        return 403;
    enum role role = access_role(&server->access, request->token);
    if (role == ROLE_NONE && needs_token(request))
        return 401;
    *tag = role;
    return request->upgrade && strcmp(request->path, "/ws") != 0 ? 404 : 0;
}

void http_request(void *context, uint64_t id, unsigned tag, const struct net_request *request, const char *body, size_t size)
{
    struct server *server = context;
    const struct route *route = find_route(request->path);
    const struct embedded_file *page = find_page(request->path);
    enum net_method method = request->method == NET_HEAD ? NET_GET : request->method;
    (void)tag;
    if (method == NET_OPTIONS)
        answer_options(server, id, request);
    else if (route && route->method == method)
        route->answer(server, id, request, body, size);
    else if (!route && page && method == NET_GET)
        answer_page(server, id, page);
    else if (route || page)
        answer_text(server, id, request, 405, TEXT, "this path takes another method\n", 31);
    else
        answer_text(server, id, request, 404, TEXT, "not found\n", 10);
}

static int status_of(enum rpc_code code)
{
    for (const struct protocol_error *e = protocol_errors; e->code; e++)
        if (e->code == code)
            return e->http;
    return 500;
}

void http_answer_error(struct server *server, uint64_t request, const char *allow_origin, enum rpc_code code,
                       const struct error *err)
{
    json_t *body = json_pack("{s:o}", "error", rpc_error_json(code, err));
    char *text = body ? json_dumps(body, JSON_COMPACT) : NULL;
    struct net_response response = {.status = status_of(code),
                                    .type = "application/json",
                                    .body = packet_from_text(text ? text : "{}", text ? strlen(text) : 2),
                                    .allow_origin = allow_origin && *allow_origin ? allow_origin : NULL};
    if (response.status == 503) {
        response.headers[0] = "retry-after:";
        response.headers[1] = "1";
    }
    net_respond(server->net, request, &response);
    free(text);
    json_decref(body);
}

void http_answer_picture(struct server *server, uint64_t request, const char *allow_origin, struct encode_job *job)
{
    static const char *const types[METRICS_CODECS] = {"image/jpeg", "image/png", "image/webp", "image/x-exr"};
    struct net_response response = {.status = 200,
                                    .type = types[job->header.codec],
                                    .body = job->packet,
                                    .offset = GNMF_HEADER_SIZE,
                                    .allow_origin = allow_origin && *allow_origin ? allow_origin : NULL};
    job->packet = NULL;
    net_respond(server->net, request, &response);
}
