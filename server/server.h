/* The daemon's parts, put together by commands/serve.c. Everything here belongs to the network thread. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>

#include "access.h"
#include "common_options.h"
#include "encode_pool.h"
#include "metrics.h"
#include "net.h"
#include "render_loop.h"
#include "scene_catalog.h"
#include "scene_store.h"
#include "session.h"

struct call;

#define SERVER_SUBPROTOCOL         "gnomon.v1"
#define SERVER_SCENES_MAX          8    /* kept in memory */
#define SERVER_STREAM_SIDE_MAX     8192 /* pixels; the frame header has 16 bits */
#define SERVER_STREAM_PIXELS_MAX   (1u << 25)
#define SERVER_SNAPSHOT_PIXELS_MAX (1u << 26)
#define SERVER_COMPARE_PIXELS_MAX  (1u << 23)

struct server {
    struct common_options *defaults; /* of every view; borrowed */
    const char *first_scene;         /* name; what view.open shows when it names none */
    struct access access;
    struct scene_catalog catalog;
    struct scene_store *scenes;
    struct encode_pool *encoders;
    struct render_loop *loop;
    struct net *net;
    struct net_handlers handlers;
    struct metrics metrics;
    struct sessions sessions;
    struct call *waiting;  /* for their scenes */
    struct call *pictures; /* for their requests at the render thread */
    atomic_bool device_lost;
};

/* Makes everything; on failure what was made is for server_finish(). `options` are borrowed. */
struct server_options {
    const char *host;
    unsigned port;
    const char *const *scene_folders;
    size_t scene_folder_count;
    const char *scene;      /* path or builtin:..., NULL: the built-in default */
    const char *token_file; /* or NULL */
    const char *const *origins;
    size_t origin_count;
    struct common_options *common;
    struct job_pool *pool;
};
bool server_init(struct server *server, const struct server_options *options, struct error *err);
/* Before net_run(): loads the first scene, so that a bad --scene ends the daemon instead of surprising its clients. */
bool server_load_first(struct server *server, struct error *err);
void server_finish(struct server *server);
