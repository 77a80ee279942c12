/* One streamed view as a state machine without threads, sockets or a clock of its own: what it wants to show, what it has shown, and
 * whether it may be rendered now. Newest state wins; a view without credit, or whose socket has not taken earlier data, is not
 * rendered at all. The caller locks. Times are clock_us(). */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "metrics.h"
#include "renderer.h"

/* Frames submitted and not acknowledged. Two keep the renderer busy while one is under way. */
#define STREAM_IN_FLIGHT      2
/* After this long without a change the picture is sent once more, at STREAM_STILL_QUALITY or better: trame's habit. */
#define STREAM_STILL_AFTER_US 200000
#define STREAM_STILL_QUALITY  90

/* With two frames on their way at once a client that stops reading finds both when it reads again. One is enough where its acknowledgement comes
 * quicker than the next frame is made, or quicker than a screen shows them. */
#define STREAM_ONE_AT_A_TIME_US 20000
/* A frame that waited longer for that than this is not sent when there is something newer to show. */
#define STREAM_STALE_US         100000

/* Everything that a view shows; whole states replace each other. */
struct view_state {
    struct render_settings settings;
    enum gnmf_codec codec;
    int quality;    /* 1..100 while moving */
    double fps_max; /* frames a second; 0: no limit */
    bool paused;
    uint32_t input_seq;     /* echoed in the header of frames that show this state */
    uint64_t input_time_us; /* likewise; the client's clock */
};

struct stream_frame {
    uint64_t number;
    uint64_t revision; /* of the state that it shows */
    uint64_t sent_us;  /* when the socket took it; 0: not yet */
};

struct stream_view {
    uint32_t id; /* 0: slot free */
    uint64_t session;
    struct scene_entry *scene;
    struct view_state wanted;
    uint64_t revision, shown; /* of `wanted`, and of the newest frame submitted */
    bool still_shown;
    bool unfinished; /* the newest frame collected: the system would add to it */
    bool blocked;    /* its socket has pending writes */
    uint64_t changed_us, submitted_us;
    uint64_t frame_number; /* of the newest frame submitted; 0: none */
    struct stream_frame in_flight[STREAM_IN_FLIGHT];
    unsigned in_flight_count;

    /* For view.stats. */
    struct frame_info last; /* of the newest frame collected */
    uint32_t encode_us;
    uint64_t rtt_us;
    uint64_t bytes, frames, dropped; /* sent, sent and dropped so far */
};

enum stream_need {
    STREAM_NOTHING,   /* what it wants is shown, or it is paused */
    STREAM_FRAME,     /* render it */
    STREAM_STILL,     /* render it, as the still frame */
    STREAM_LATER,     /* not before *due_us */
    STREAM_NO_CREDIT, /* an acknowledgement must come first */
    STREAM_BLOCKED,   /* the socket must drain first */
};

enum stream_need stream_view_need(const struct stream_view *v, uint64_t now_us, uint64_t *due_us);

/* Replaces the wanted state. True when the one before was never shown; *reason says what stood in its way. */
bool stream_view_update(struct stream_view *v, const struct view_state *state, uint64_t now_us, enum drop_reason *reason);

/* A frame of the wanted state goes to the renderer: takes credit, returns its number. */
uint64_t stream_view_submit(struct stream_view *v, bool still, uint64_t now_us);

/* A submitted frame will never be sent: its credit comes back. */
void stream_view_lost(struct stream_view *v, uint64_t frame);

void stream_view_sent(struct stream_view *v, uint64_t frame, uint32_t encode_us, size_t bytes, uint64_t now_us);

/* Whether a frame may be given to the socket now, or has to wait for the acknowledgement of the one before it. */
bool stream_view_may_send(const struct stream_view *v);
/* Whether a frame that has waited since then is not worth sending any more: a newer state is to be shown in its place. */
bool stream_view_is_stale(const struct stream_view *v, uint64_t frame, uint64_t since_us, uint64_t now_us);

/* Acknowledges `frame` and all before it. False when no such frame has been sent. */
bool stream_view_ack(struct stream_view *v, uint64_t frame, uint64_t now_us);
