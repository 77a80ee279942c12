/* What the render thread and those who talk to it share. For render_loop.c (the thread) and render_inbox.c (the others) alone. */
#pragma once

#include <pthread.h>

#include "render_loop.h"

struct compare_task;

struct render_loop {
    struct render_loop_options options;
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t changed;

    /* Guarded. */
    struct stream_view views[RENDER_LOOP_VIEWS];
    struct render_request *snapshots, *compares; /* waiting, oldest first */
    size_t snapshot_count, compare_count;
    struct scene_entry *retired, *remaining; /* `remaining`: at the end, not ours to free */
    bool stopping, started, failed;
    uint64_t events; /* counts every change: what the thread has seen tells whether to sleep */
    struct error start_error;

    /* Render thread. */
    struct renderer *renderer;
    struct device_info device;
    struct encode_job *in_flight[RENDERER_IN_FLIGHT]; /* submitted, oldest first */
    struct scene_entry *in_flight_scene[RENDERER_IN_FLIGHT];
    size_t in_flight_algorithm[RENDERER_IN_FLIGHT];
    unsigned in_flight_count;
    unsigned turn;      /* where the search for the next view begins */
    bool snapshot_last; /* snapshots and views take turns */
    uint64_t token;
    struct compare_task *comparing; /* one at a time */
};

/* Locked. Tells the thread that something it may wait for has changed. */
void render_loop_changed(struct render_loop *loop);
/* Locked. NULL when there is none. */
struct stream_view *render_loop_find_view(struct render_loop *loop, uint32_t view);
