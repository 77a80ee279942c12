/* Encoder threads. A worker touches only its own job; what is finished is handed back to the network thread, oldest first, so sessions
 * need no locks. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "frame_packet.h"

struct encode_pool;

struct encode_job {
    struct encode_job *link;
    uint64_t session;           /* whom the picture is for */
    struct frame_header header; /* encode_us is filled in by the pool */
    int quality;                /* 1..100; JPEG and WebP */
    void *pixels;               /* from encode_pool_buffer(); rgba8, or rgba32f for EXR */
    size_t pixels_capacity;
    uint32_t width, height;         /* pixels; a snapshot's may not fit the header's 16 bits */
    struct render_request *request; /* NULL for a stream frame; not touched here */

    /* Result: one of the two; neither for what has no picture. */
    struct packet *packet; /* header and payload */
    struct error err;
};

struct encode_job *encode_job_create(void); /* zeroed; NULL when memory is out */
/* Accepts NULL. Neither `request` nor pixels still in use may be left. */
void encode_job_destroy(struct encode_job *job);

/* `done` is called on a worker after each job. */
struct encode_pool *encode_pool_create(unsigned threads, void (*done)(void *context), void *context, struct error *err);
/* Waits for running jobs; those queued are handed back unencoded by a last encode_pool_take() before it. Accepts NULL. */
void encode_pool_stop(struct encode_pool *pool);
void encode_pool_destroy(struct encode_pool *pool);

/* Pixel memory for a job, recycled between frames. False when memory is out. Any thread. */
bool encode_pool_buffer(struct encode_pool *pool, struct encode_job *job, size_t size);

/* Any thread; the pool owns the job until it is taken. Jobs of one view (header.view, streams only) finish in the order submitted. */
void encode_pool_submit(struct encode_pool *pool, struct encode_job *job);
/* Hands a job with nothing to encode straight back. */
void encode_pool_return(struct encode_pool *pool, struct encode_job *job);
/* The same for one that failed (err set). */
void encode_pool_fail(struct encode_pool *pool, struct encode_job *job);

/* Jobs submitted and not finished. Any thread. */
size_t encode_pool_pending(struct encode_pool *pool);

/* All finished jobs since the last call, oldest first, linked; the caller owns them. */
struct encode_job *encode_pool_take(struct encode_pool *pool);
