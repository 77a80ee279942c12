#include "server.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"
#include "base/log.h"
#include "answer.h"
#include "dispatch.h"
#include "frame_sender.h"
#include "http.h"
#include "methods/methods.h"
#include "pending.h"

#define FIRST_SCENE         "builtin:box"
/* One core encodes 1080p at 5.6 ms (libjpeg-turbo, q80): half the threads are plenty beside a renderer. */
#define ENCODERS_OF_THREADS 2
#define ENCODERS_MOST       4
#define LOAD_POLL_US        2000

static void wake_net(void *context)
{
    struct server *server = context;
    if (server->net)
        net_wake(server->net);
}

/* On an encoder, or the render thread. */
static void on_encoded(void *context)
{
    struct server *server = context;
    if (server->loop)
        render_loop_kick(server->loop);
    wake_net(context);
}

static void on_device_lost(void *context)
{
    struct server *server = context;
    atomic_store(&server->device_lost, true);
    net_stop(server->net);
}

static void on_opened(void *context, uint64_t id, unsigned tag)
{
    struct server *server = context;
    if (!sessions_add(&server->sessions, id, (enum role)tag)) {
        net_close(server->net, id, 1011, "out of memory");
        return;
    }
    atomic_fetch_add(&server->metrics.clients, 1);
    rpc_notify(server, id, NOTIFY_SERVER_HELLO, hello_params(server, id));
}

static void on_message(void *context, uint64_t id, const char *text, size_t size) { dispatch_message(context, id, text, size); }

static void on_closed(void *context, uint64_t id)
{
    struct server *server = context;
    pending_forget(server, id);
    for (struct view_record *view; (view = sessions_first_view_of(&server->sessions, id));)
        view_close(server, view);
    if (!sessions_find(&server->sessions, id))
        return;
    sessions_remove(&server->sessions, id);
    atomic_fetch_sub(&server->metrics.clients, 1);
}

static void on_blocked(void *context, uint64_t id, bool blocked)
{
    struct server *server = context;
    render_loop_blocked(server->loop, id, blocked);
}

static void take_pictures(struct server *server)
{
    for (struct encode_job *job = encode_pool_take(server->encoders), *next; job; job = next) {
        next = job->link;
        if (!job->request) {
            frame_sender_take(server, job);
            continue;
        }
        pending_answer(server, job);
        encode_job_destroy(job);
    }
}

static void on_woken(void *context)
{
    struct server *server = context;
    if (scene_store_settle(server->scenes))
        pending_scenes_ready(server);
    pending_tell(server);
    take_pictures(server);
}

static void on_scene_changed(void *context, const struct scene_entry *entry, bool removed)
{
    struct server *server = context;
    for (const struct session *session = server->sessions.first; session; session = session->link) {
        json_t *views = json_array();
        for (const struct view_record *view = server->sessions.views; view; view = view->link)
            if (view->session == session->id && view->scene == entry)
                json_array_append_new(views, json_integer(view->id));
        rpc_notify(server, session->id, NOTIFY_SCENE_CHANGED,
                   json_pack("{s:s, s:s, s:o}", "scene", entry->name, "reason", removed ? "removed" : "changed", "views", views));
    }
}

/* A client that has not taken the last second's figures does not get this second's. */
static void on_tick(void *context)
{
    struct server *server = context;
    scene_store_watch(server->scenes, on_scene_changed, server);
    for (struct view_record *view = server->sessions.views; view; view = view->link) {
        json_t *stats = view_stats(server, view, 1.0, &view->frames_told, &view->bytes_told);
        if (stats && net_queued(server->net, view->session) == 0)
            rpc_notify(server, view->session, NOTIFY_VIEW_STATS, stats);
        else
            json_decref(stats);
    }
}

static bool fill_catalog(struct server *server, const struct server_options *o, struct error *err)
{
    server->first_scene = FIRST_SCENE;
    if (o->scene && scene_is_builtin(o->scene)) {
        server->first_scene = o->scene;
    } else if (o->scene) {
        if (!scene_catalog_add_file(&server->catalog, o->scene, err))
            return false;
        server->first_scene = server->catalog.files.data[0].name;
    }
    for (size_t i = 0; i < o->scene_folder_count; i++)
        if (!scene_catalog_add_folder(&server->catalog, o->scene_folders[i], err))
            return false;
    return true;
}

static bool fill_access(struct access *access, const struct server_options *o, struct error *err)
{
    access->listen_host = o->host;
    access->loopback = access_is_loopback(o->host);
    access->origins = o->origins;
    access->origin_count = o->origin_count;
    if (!access->loopback && !o->token_file)
        return error_set(
            err, ERROR_USAGE, "--listen",
            "--listen %s is reachable from other machines and needs --token-file; without one a loopback address is accepted",
            o->host);
    return !o->token_file || access_read_tokens(access, o->token_file, err);
}

static bool start_threads(struct server *server, const struct server_options *o, struct error *err)
{
    unsigned encoders = o->common->threads / ENCODERS_OF_THREADS;
    encoders = encoders < 1 ? 1 : encoders > ENCODERS_MOST ? ENCODERS_MOST : encoders;
    if (!(server->scenes = scene_store_create(&server->catalog, SERVER_SCENES_MAX, wake_net, server, err)))
        return false;
    if (!(server->encoders = encode_pool_create(encoders, on_encoded, server, err)))
        return false;
    struct render_loop_options options = {.renderer = common_options_renderer(o->common),
                                          .pool = o->pool,
                                          .encoders = server->encoders,
                                          .metrics = &server->metrics,
                                          .lost = on_device_lost,
                                          .context = server};
    return (server->loop = render_loop_create(&options, err));
}

bool server_init(struct server *server, const struct server_options *o, struct error *err)
{
    memset(server, 0, sizeof *server);
    server->defaults = o->common;
    server->handlers = (struct net_handlers){.context = server,
                                             .admit = http_admit,
                                             .request = http_request,
                                             .opened = on_opened,
                                             .message = on_message,
                                             .blocked = on_blocked,
                                             .closed = on_closed,
                                             .woken = on_woken,
                                             .tick = on_tick};
    if (!fill_access(&server->access, o, err) || !fill_catalog(server, o, err))
        return false;
    /* The port before the device: a second daemon on the same port should fail at once. */
    if (!(server->net = net_create(o->host, o->port, SERVER_SUBPROTOCOL, &server->handlers, err)))
        return false;
    return start_threads(server, o, err);
}

void server_finish(struct server *server)
{
    struct scene_entry *scenes = server->scenes ? scene_store_stop(server->scenes) : NULL;
    if (server->loop)
        render_loop_stop(server->loop, scenes);
    if (server->encoders) {
        encode_pool_stop(server->encoders);
        take_pictures(server);
    }
    net_destroy(server->net);
    render_loop_destroy(server->loop);
    encode_pool_destroy(server->encoders);
    scene_store_destroy(server->scenes);
    scene_catalog_finish(&server->catalog);
    access_finish(&server->access);
}

bool server_load_first(struct server *server, struct error *err)
{
    struct scene_entry *evicted, *entry = scene_store_get(server->scenes, server->first_scene, &evicted, err);
    if (!entry)
        return false;
    while (entry->status == SCENE_LOADING) {
        usleep(LOAD_POLL_US);
        scene_store_settle(server->scenes);
    }
    bool ok = entry->status == SCENE_READY;
    if (!ok)
        *err = entry->err;
    scene_entry_unref(entry);
    return ok;
}
