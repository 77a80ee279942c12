/* Who is connected and what they look at: the network thread's books. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "access.h"
#include "cameras.h"
#include "stream_view.h"

struct scene_entry;

#define SESSION_VIEWS_MAX 8

/* What a client asked of a view, from which each state is made. */
struct view_record {
    uint32_t id;
    uint64_t session;
    struct scene_entry *scene; /* one reference */
    double size[2], dpr;       /* CSS pixels, and device pixels in each */
    struct camera_choice camera;
    char camera_name[64]; /* what camera.name points to */
    struct view_state state;
    struct encode_job *held;          /* a finished frame that waits for an acknowledgement; owned by frame_sender */
    uint64_t held_us;                 /* since when */
    uint64_t frames_told, bytes_told; /* as of the last view.stats */
    struct view_record *link;
};

struct session {
    uint64_t id;
    enum role role;
    unsigned view_count;
    struct session *link;
};

struct sessions {
    struct session *first;
    struct view_record *views;
    uint32_t last_view;
    size_t view_count;
};

struct session *sessions_add(struct sessions *sessions, uint64_t id, enum role role); /* NULL when memory is out */
struct session *sessions_find(struct sessions *sessions, uint64_t id);
/* Its views must be gone. */
void sessions_remove(struct sessions *sessions, uint64_t id);

/* A view with a new id, owned by `session`; takes a reference to `scene`. NULL when memory is out. */
struct view_record *sessions_add_view(struct sessions *sessions, struct session *session, struct scene_entry *scene);
/* NULL when there is none, or it is another session's. */
struct view_record *sessions_find_view(struct sessions *sessions, uint64_t session, uint32_t view);
void sessions_remove_view(struct sessions *sessions, struct view_record *view);
struct view_record *sessions_first_view_of(struct sessions *sessions, uint64_t session);
