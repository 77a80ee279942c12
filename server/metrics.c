#include "metrics.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include "frame_packet.h"
#include "shadow/shadow.h"

const char *const drop_reason_names[DROP_REASONS] = {"busy", "credit", "socket", "closed", "failed"};
const char *const codec_names[METRICS_CODECS + 1] = {"jpeg", "png", "webp", "exr", NULL};

/* Milliseconds; dense around the 16 and 33 ms that a viewer feels. */
static const double bucket_ms[METRICS_BUCKETS] = {1, 2, 4, 8, 16, 24, 33, 50, 75, 100, 200, 500, 1000, 5000};

void metrics_frame(struct metrics *m, size_t algorithm, double frame_ms)
{
    size_t bucket = 0;
    while (bucket < METRICS_BUCKETS && !(frame_ms <= bucket_ms[bucket]))
        bucket++;
    atomic_fetch_add(&m->frame_bucket[bucket], 1);
    atomic_fetch_add(&m->frame_sum_us, frame_microseconds(frame_ms));
    if (algorithm < METRICS_ALGORITHMS)
        atomic_fetch_add(&m->rendered[algorithm], 1);
}

static void head(FILE *out, const char *name, const char *type, const char *help)
{
    fprintf(out, "# HELP %s %s\n# TYPE %s %s\n", name, help, name, type);
}

static void format_labelled(FILE *out, const char *name, const char *label, const char *const *values,
                            const _Atomic uint64_t *counts, size_t count)
{
    for (size_t i = 0; i < count; i++)
        fprintf(out, "%s{%s=\"%s\"} %" PRIu64 "\n", name, label, values[i], atomic_load(&counts[i]));
}

static void format_histogram(FILE *out, const struct metrics *m)
{
    head(out, "gnomon_frame_seconds", "histogram", "Time from the start of a frame to its pixels in memory.");
    uint64_t total = 0;
    for (size_t i = 0; i < METRICS_BUCKETS; i++) {
        total += atomic_load(&m->frame_bucket[i]);
        fprintf(out, "gnomon_frame_seconds_bucket{le=\"%g\"} %" PRIu64 "\n", bucket_ms[i] / 1000, total);
    }
    total += atomic_load(&m->frame_bucket[METRICS_BUCKETS]);
    fprintf(out, "gnomon_frame_seconds_bucket{le=\"+Inf\"} %" PRIu64 "\n", total);
    fprintf(out, "gnomon_frame_seconds_sum %.6f\n", (double)atomic_load(&m->frame_sum_us) * 1e-6);
    fprintf(out, "gnomon_frame_seconds_count %" PRIu64 "\n", total);
}

static void format_all(FILE *out, const struct metrics *m)
{
    head(out, "gnomon_frames_rendered_total", "counter", "Frames rendered, by shadow algorithm.");
    for (size_t i = 0; i < shadow_system_count && i < METRICS_ALGORITHMS; i++)
        fprintf(out, "gnomon_frames_rendered_total{algorithm=\"%s\"} %" PRIu64 "\n", shadow_systems[i]->name,
                atomic_load(&m->rendered[i]));
    head(out, "gnomon_frames_sent_total", "counter", "Stream frames handed to sockets, by codec.");
    format_labelled(out, "gnomon_frames_sent_total", "codec", codec_names, m->sent, METRICS_CODECS);
    head(out, "gnomon_frames_dropped_total", "counter", "States asked for and never shown, by reason; dropped before the work.");
    format_labelled(out, "gnomon_frames_dropped_total", "reason", drop_reason_names, m->dropped, DROP_REASONS);
    head(out, "gnomon_frame_bytes_sent_total", "counter", "Bytes of stream frames handed to sockets.");
    fprintf(out, "gnomon_frame_bytes_sent_total %" PRIu64 "\n", atomic_load(&m->bytes_sent));
    head(out, "gnomon_snapshots_total", "counter", "Pictures rendered on request.");
    fprintf(out, "gnomon_snapshots_total %" PRIu64 "\n", atomic_load(&m->snapshots));
    head(out, "gnomon_clients", "gauge", "WebSocket clients connected.");
    fprintf(out, "gnomon_clients %" PRId64 "\n", atomic_load(&m->clients));
    head(out, "gnomon_views", "gauge", "Open views.");
    fprintf(out, "gnomon_views %" PRId64 "\n", atomic_load(&m->views));
    format_histogram(out, m);
}

char *metrics_format(const struct metrics *m, size_t *size)
{
    char *text = NULL;
    FILE *out = open_memstream(&text, size);
    if (!out)
        return NULL;
    format_all(out, m);
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}
