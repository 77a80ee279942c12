/* Counters for /metrics, Prometheus text format 0.0.4. Counting is safe from any thread. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "proto/frame_header.h"

#define METRICS_ALGORITHMS 32
#define METRICS_CODECS     4
#define METRICS_BUCKETS    14

/* Why a state that a client asked for was never rendered, or a frame never sent. */
enum drop_reason {
    DROP_BUSY,   /* a newer state came while another frame was being rendered */
    DROP_CREDIT, /* ... while the client had not acknowledged earlier frames */
    DROP_SOCKET, /* ... while the socket had not taken earlier data */
    DROP_CLOSED, /* the view or client was gone when the frame was ready */
    DROP_FAILED, /* rendering or encoding failed */
    DROP_REASONS,
};

struct metrics {
    _Atomic uint64_t rendered[METRICS_ALGORITHMS]; /* by index in shadow_systems */
    _Atomic uint64_t sent[METRICS_CODECS];         /* by enum gnmf_codec */
    _Atomic uint64_t dropped[DROP_REASONS];
    _Atomic uint64_t bytes_sent;
    _Atomic uint64_t frame_bucket[METRICS_BUCKETS + 1]; /* not cumulative; the last is +Inf */
    _Atomic uint64_t frame_sum_us;
    _Atomic uint64_t snapshots;
    _Atomic int64_t clients; /* WebSocket clients now */
    _Atomic int64_t views;   /* open views now */
};

extern const char *const drop_reason_names[DROP_REASONS];
extern const char *const codec_names[METRICS_CODECS + 1]; /* by enum gnmf_codec; ended by NULL */

/* A frame's time from submission to its pixels in CPU memory. */
void metrics_frame(struct metrics *m, size_t algorithm, double frame_ms);

/* The page; caller frees. NULL when memory is out. */
char *metrics_format(const struct metrics *m, size_t *size);
