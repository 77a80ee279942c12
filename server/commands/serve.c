#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "command.h"
#include "common_options.h"
#include "numbers.h"
#include "server.h"

#define HOST_DEFAULT     "127.0.0.1"
#define PORT_DEFAULT     8080
/* The promise is 5 s from the signal to the exit: whatever still renders or loads then is abandoned. Taking down a process that is at work on
 * every core took another 0.7 s. */
#define SHUTDOWN_SECONDS 3
#define LIST_MAX         64

struct serve_options {
    char host[256];
    unsigned port;
    const char *folders[LIST_MAX], *origins[LIST_MAX];
    size_t folder_count, origin_count;
    const char *scene, *token_file;
};

static bool set_listen(void *target, const char *value, struct error *err)
{
    struct serve_options *o = target;
    const char *colon = strrchr(value, ':');
    unsigned long port;
    size_t length = colon ? (size_t)(colon - value) : 0;
    bool bracketed = length > 2 && value[0] == '[' && value[length - 1] == ']';
    if (length == 0 || length >= sizeof o->host || !number_parse_unsigned(colon + 1, 0, 65535, &port) ||
        (!bracketed && memchr(value, ':', length)))
        return error_set(err, ERROR_USAGE, "listen",
                         "ADDR:PORT is accepted, such as 127.0.0.1:8080, [::1]:8080 or 127.0.0.1:0 for a free port");
    snprintf(o->host, sizeof o->host, "%.*s", (int)(bracketed ? length - 2 : length), value + bracketed);
    o->port = (unsigned)port;
    return true;
}

static bool append(const char **list, size_t *count, const char *value, struct error *err)
{
    if (!*value || *count == LIST_MAX)
        return error_set(err, ERROR_USAGE, NULL, "up to %d values that are not empty are accepted", LIST_MAX);
    list[(*count)++] = value;
    return true;
}

static bool set_scenes(void *target, const char *value, struct error *err)
{
    struct serve_options *o = target;
    return append(o->folders, &o->folder_count, value, err);
}

static bool set_origin(void *target, const char *value, struct error *err)
{
    struct serve_options *o = target;
    const char *host = strstr(value, "://");
    if (!host || !host[3] || strchr(host + 3, '/'))
        return error_set(err, ERROR_USAGE, "allow-origin",
                         "SCHEME://HOST[:PORT] without a path is accepted, such as https://example.org");
    return append(o->origins, &o->origin_count, value, err);
}

static bool set_scene(void *target, const char *value, struct error *err)
{
    struct serve_options *o = target;
    (void)err;
    o->scene = value;
    return true;
}

static bool set_token_file(void *target, const char *value, struct error *err)
{
    struct serve_options *o = target;
    (void)err;
    o->token_file = value;
    return true;
}

static const struct option serve_table[] = {
    {"listen", "ADDR:PORT",
     "where to listen (default 127.0.0.1:8080; port 0: any free one); not a loopback address: needs --token-file", set_listen},
    {"scenes", "DIR", "offer the .gltf and .glb files below DIR; repeat for more", set_scenes},
    {"scene", "SCENE", "the scene that clients see first: a file or builtin:NAME (default builtin:box)", set_scene},
    {"token-file", "FILE", "let in only who shows a token; lines 'view TOKEN' or 'control TOKEN'", set_token_file},
    {"allow-origin", "ORIGIN", "let pages from ORIGIN talk to this server; repeat for more", set_origin},
    {0},
};

static const struct syntax serve_syntax = {
    .command = "serve",
    .usage = "[--listen ADDR:PORT] [--scenes DIR]... [--scene SCENE] [--token-file F] [--allow-origin O]... [OPTION]...",
    .summary = "Serve scenes to browsers and scripts: a viewer at /, a WebSocket at /ws, pictures from POST /v1/render.",
    .common = true,
    .options = serve_table,
    .notes = "Prints \"gnomon: ready http://ADDR:PORT/\" on standard output once it can answer. SIGTERM and SIGINT end it.\n"
             "The common options are what a view shows until its client asks for something else.",
    .examples = "gnomon serve --scenes /data/scenes --scene builtin:ball\n"
                "curl -d '{\"scene\":\"builtin:box\",\"size\":[640,360]}' http://127.0.0.1:8080/v1/render -o box.png\n",
};

/* Waits for the signals that end the daemon: they are blocked in every other thread. */
struct stopper {
    pthread_mutex_t mutex;
    struct net *net; /* guarded; NULL when there is none to stop */
    bool stopped;    /* guarded */
    sigset_t signals;
};

static void *stopper_main(void *argument)
{
    struct stopper *stopper = argument;
    int number;
    while (sigwait(&stopper->signals, &number) != 0)
        ;
    pthread_mutex_lock(&stopper->mutex);
    stopper->stopped = true;
    if (stopper->net)
        net_stop(stopper->net);
    pthread_mutex_unlock(&stopper->mutex);
    sleep(SHUTDOWN_SECONDS);
    _exit(0);
}

/* Before any other thread, which inherit the blocked signals. The thread outlives the command, so its struct is never freed. */
static struct stopper *start_stopper(struct error *err)
{
    struct stopper *stopper = calloc(1, sizeof *stopper);
    pthread_t thread;
    if (!stopper) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the signal thread");
        return NULL;
    }
    pthread_mutex_init(&stopper->mutex, NULL);
    sigemptyset(&stopper->signals);
    sigaddset(&stopper->signals, SIGTERM);
    sigaddset(&stopper->signals, SIGINT);
    signal(SIGPIPE, SIG_IGN);
    pthread_sigmask(SIG_BLOCK, &stopper->signals, NULL);
    int failure = pthread_create(&thread, NULL, stopper_main, stopper);
    if (failure) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "cannot start the signal thread: %s", strerror(failure));
        free(stopper);
        return NULL;
    }
    pthread_detach(thread);
    return stopper;
}

static void run(struct stopper *stopper, struct server *server, const struct serve_options *o)
{
    pthread_mutex_lock(&stopper->mutex);
    bool stopped = stopper->stopped;
    stopper->net = server->net;
    pthread_mutex_unlock(&stopper->mutex);
    if (!stopped) {
        bool v6 = strchr(o->host, ':');
        printf("gnomon: ready http://%s%s%s:%u/\n", v6 ? "[" : "", o->host, v6 ? "]" : "", net_port(server->net));
        fflush(stdout);
        net_run(server->net);
    }
    pthread_mutex_lock(&stopper->mutex);
    stopper->net = NULL;
    pthread_mutex_unlock(&stopper->mutex);
}

static bool serve(const struct serve_options *o, struct stopper *stopper, struct common_options *common, struct job_pool *pool,
                  struct error *err)
{
    struct server *server = calloc(1, sizeof *server);
    bool ok = false;
    if (!server)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the server");
    struct server_options options = {.host = o->host,
                                     .port = o->port,
                                     .scene_folders = o->folders,
                                     .scene_folder_count = o->folder_count,
                                     .scene = o->scene,
                                     .token_file = o->token_file,
                                     .origins = o->origins,
                                     .origin_count = o->origin_count,
                                     .common = common,
                                     .pool = pool};
    if (server_init(server, &options, err) && server_load_first(server, err)) {
        run(stopper, server, o);
        ok = !atomic_load(&server->device_lost) ||
             error_set(err, ERROR_TRY_AGAIN, NULL, "the GPU device was lost; start the server again");
    }
    server_finish(server);
    free(server);
    return ok;
}

int command_serve(int argc, char **argv)
{
    struct serve_options options = {.host = HOST_DEFAULT, .port = PORT_DEFAULT};
    struct common_options common;
    struct error err = {0};
    common_options_init(&common);
    int code = options_start(&serve_syntax, argc, argv, &options, &common, NULL);
    if (code >= 0)
        return code;
    if (common.difference) {
        error_set(&err, ERROR_USAGE, "show", "--show difference is for render; clients of a server call compare.run");
        return command_fail(&err);
    }
    struct stopper *stopper = start_stopper(&err);
    struct job_pool *pool = stopper ? job_pool_create(common.threads, &err) : NULL;
    bool ok = pool && serve(&options, stopper, &common, pool, &err);
    job_pool_destroy(pool);
    return ok ? 0 : command_fail(&err);
}
