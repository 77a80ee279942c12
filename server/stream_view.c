#include "stream_view.h"

#include <assert.h>

static uint64_t least_interval_us(const struct stream_view *v)
{
    return v->wanted.fps_max > 0 ? (uint64_t)(1e6 / v->wanted.fps_max) : 0;
}

enum stream_need stream_view_need(const struct stream_view *v, uint64_t now_us, uint64_t *due_us)
{
    bool changed = v->shown != v->revision || v->unfinished;
    if (v->wanted.paused || (!changed && v->still_shown))
        return STREAM_NOTHING;
    if (v->blocked)
        return STREAM_BLOCKED;
    if (v->in_flight_count >= STREAM_IN_FLIGHT)
        return STREAM_NO_CREDIT;
    uint64_t due = changed ? 0 : v->changed_us + STREAM_STILL_AFTER_US;
    if (v->frame_number > 0 && due < v->submitted_us + least_interval_us(v))
        due = v->submitted_us + least_interval_us(v);
    if (now_us < due) {
        *due_us = due;
        return STREAM_LATER;
    }
    return changed ? STREAM_FRAME : STREAM_STILL;
}

bool stream_view_update(struct stream_view *v, const struct view_state *state, uint64_t now_us, enum drop_reason *reason)
{
    bool dropped = v->shown != v->revision && !v->wanted.paused;
    if (dropped) {
        *reason = v->blocked ? DROP_SOCKET : v->in_flight_count >= STREAM_IN_FLIGHT ? DROP_CREDIT : DROP_BUSY;
        v->dropped++;
    }
    v->wanted = *state;
    v->revision++;
    v->changed_us = now_us;
    return dropped;
}

uint64_t stream_view_submit(struct stream_view *v, bool still, uint64_t now_us)
{
    assert(v->in_flight_count < STREAM_IN_FLIGHT);
    v->shown = v->revision;
    v->still_shown = still;
    v->submitted_us = now_us;
    v->in_flight[v->in_flight_count++] = (struct stream_frame){.number = ++v->frame_number, .revision = v->revision};
    return v->frame_number;
}

static struct stream_frame *find_frame(struct stream_view *v, uint64_t frame)
{
    for (unsigned i = 0; i < v->in_flight_count; i++)
        if (v->in_flight[i].number == frame)
            return &v->in_flight[i];
    return NULL;
}

/* Forgets the first `count` frames in flight from `at` on. */
static void forget(struct stream_view *v, unsigned at, unsigned count)
{
    for (unsigned i = at; i + count < v->in_flight_count; i++)
        v->in_flight[i] = v->in_flight[i + count];
    v->in_flight_count -= count;
}

void stream_view_lost(struct stream_view *v, uint64_t frame)
{
    struct stream_frame *found = find_frame(v, frame);
    if (!found)
        return;
    forget(v, (unsigned)(found - v->in_flight), 1);
    v->dropped++;
}

void stream_view_sent(struct stream_view *v, uint64_t frame, uint32_t encode_us, size_t bytes, uint64_t now_us)
{
    struct stream_frame *found = find_frame(v, frame);
    if (found)
        found->sent_us = now_us;
    v->encode_us = encode_us;
    v->bytes += bytes;
    v->frames++;
}

bool stream_view_may_send(const struct stream_view *v)
{
    unsigned under_way = 0;
    for (unsigned i = 0; i < v->in_flight_count; i++)
        under_way += v->in_flight[i].sent_us > 0;
    double made_us = v->last.frame_ms * 1000 + v->encode_us;
    return under_way == 0 || (v->rtt_us > STREAM_ONE_AT_A_TIME_US && (double)v->rtt_us > made_us);
}

bool stream_view_is_stale(const struct stream_view *v, uint64_t frame, uint64_t since_us, uint64_t now_us)
{
    const struct stream_frame *found = find_frame((struct stream_view *)v, frame);
    return (!found || found->revision != v->revision) && now_us - since_us > STREAM_STALE_US;
}

bool stream_view_ack(struct stream_view *v, uint64_t frame, uint64_t now_us)
{
    if (frame == 0 || frame > v->frame_number)
        return false;
    unsigned done = 0;
    while (done < v->in_flight_count && v->in_flight[done].number <= frame) {
        if (v->in_flight[done].sent_us == 0)
            return false;
        if (v->in_flight[done].number == frame)
            v->rtt_us = now_us - v->in_flight[done].sent_us;
        done++;
    }
    forget(v, 0, done);
    return true;
}
