/* What the render thread and those who talk to it share. For render_loop.c (the thread), render_pick.c, render_flight.c and render_compare.c (its
 * steps) and render_inbox.c (the others) alone. */
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

/* ---- the thread's steps ---- */

/* What it picked to render, copied out of the lock. */
struct picked {
    struct encode_job *job;
    struct scene_entry *scene; /* one reference */
    struct render_settings settings;
};

/* Locked. The next view that needs a frame and may have one; *due_us falls to the earliest that only has to wait. */
bool render_pick_view(struct render_loop *loop, struct picked *out, uint64_t *due_us);
/* Locked. That, or a snapshot: they take turns. */
bool render_pick(struct render_loop *loop, struct picked *out, uint64_t *due_us);
/* Locked. The oldest of `list` as a job; NULL when there is none. */
struct encode_job *render_pick_request(struct render_request **list, size_t *count);

bool render_flight_has_room(struct render_loop *loop);
/* `picked`'s job and reference pass on, to the ring or to the failed. */
void render_flight_submit(struct render_loop *loop, const struct picked *picked);
/* Gives the oldest frame to the encoders. True when one came out. */
bool render_flight_collect(struct render_loop *loop, bool wait);
/* The oldest could not be collected and will not be. */
void render_flight_drop(struct render_loop *loop);
/* Gives a job back without a picture, saying why. */
void render_flight_fail(struct render_loop *loop, struct encode_job *job, const struct error *err);
/* Puts the scene on the device, where it is not yet. */
bool render_flight_upload(struct render_loop *loop, struct scene_entry *scene, struct error *err);
/* True, with err, when nobody wants it any more. */
bool render_request_is_late(const struct render_request *request, struct error *err);
size_t render_algorithm_index(const struct shadow_system *system);

/* The device's share of a comparison; the rest runs on the task's own thread. */
void render_compare_run(struct render_loop *loop, struct encode_job *job);
/* Cleans up after a comparison that is done; `wait`: after any. */
void render_compare_finish(struct render_loop *loop, bool wait);
