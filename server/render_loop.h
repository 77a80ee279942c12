/* The render thread: owns the renderer and its GL context, all of renderer.h is called here. Takes whole view states (newest wins) and
 * requests (in order), gives pixels to the encode pool. Never waits for a client, nor for a read-back while there is other work. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "encode_pool.h"
#include "render_request.h"
#include "stream_view.h"

struct job_pool;
struct metrics;
struct render_loop;
struct scene_entry;

#define RENDER_LOOP_VIEWS     64
#define RENDER_LOOP_SNAPSHOTS 16
#define RENDER_LOOP_COMPARES  4

struct render_loop_options {
    struct renderer_options renderer;
    struct job_pool *pool;        /* outlives the loop */
    struct encode_pool *encoders; /* likewise; sends back the requests too */
    struct metrics *metrics;      /* likewise */
    void (*lost)(void *context);  /* called on the render thread when the device is lost for good */
    void *context;
};

/* Starts the thread and waits until its renderer stands. NULL with the renderer's error. */
struct render_loop *render_loop_create(const struct render_loop_options *options, struct error *err);
/* Ends the thread: finishes what is in flight, hands waiting requests back, destroys the renderer and, of the scenes in `scenes` (linked),
 * what lies on the device. The functions below may still be called. */
void render_loop_stop(struct render_loop *loop, struct scene_entry *scenes);
/* After render_loop_stop(), with every view closed. Accepts NULL. */
void render_loop_destroy(struct render_loop *loop);

/* All below: any thread, never wait for the GPU. */

/* Takes its own reference to `scene` (READY). False when RENDER_LOOP_VIEWS are open. */
bool render_loop_open(struct render_loop *loop, uint32_t view, uint64_t session, struct scene_entry *scene,
                      const struct view_state *state);
/* Replaces the state. */
void render_loop_update(struct render_loop *loop, uint32_t view, const struct view_state *state);
void render_loop_close(struct render_loop *loop, uint32_t view);
/* False when `frame` is none that was sent. */
bool render_loop_ack(struct render_loop *loop, uint32_t view, uint64_t frame);
void render_loop_sent(struct render_loop *loop, uint32_t view, uint64_t frame, uint32_t encode_us, size_t bytes);
/* stream_view_may_send() and stream_view_is_stale() of the view; true for one that is gone. */
bool render_loop_may_send(struct render_loop *loop, uint32_t view);
bool render_loop_is_stale(struct render_loop *loop, uint32_t view, uint64_t frame, uint64_t since_us);
void render_loop_lost(struct render_loop *loop, uint32_t view, uint64_t frame);
/* Whether the session's socket has pending writes. */
void render_loop_blocked(struct render_loop *loop, uint64_t session, bool blocked);

/* Takes the request over; it comes back as an encode job. False (not taken) when RENDER_LOOP_SNAPSHOTS or _COMPARES wait. */
bool render_loop_request(struct render_loop *loop, struct render_request *request);

/* A copy of the view as it is now, for statistics. False when there is no such view. */
bool render_loop_view(struct render_loop *loop, uint32_t view, struct stream_view *out);

/* An evicted scene, for the render thread to destroy. */
void render_loop_retire(struct render_loop *loop, struct scene_entry *scene);

/* Something it may wait for has changed: an encoder is free. */
void render_loop_kick(struct render_loop *loop);

const struct device_info *render_loop_device(const struct render_loop *loop);
