/* A picture or a comparison on request, beside the streams. Made and freed by the network thread; in between the render thread and the
 * comparing one read it, and write what is said to be atomic. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include <jansson.h>

#include "against.h"
#include "proto/frame_header.h"
#include "renderer.h"

struct scene_entry;

/* The words of $/progress. */
enum request_stage { STAGE_LOADING, STAGE_WAITING, STAGE_RENDERING, STAGE_COMPARING, STAGE_ENCODING };
extern const char *const request_stage_names[];

struct render_request {
    struct render_request *link;
    struct scene_entry *scene; /* one reference */
    struct render_settings settings;
    enum gnmf_codec codec;
    int quality;
    uint64_t session;
    uint32_t request_id;
    unsigned rounds;        /* frames rendered for it so far */
    uint64_t deadline_us;   /* clock_us(); 0: none. Not started after it */
    _Atomic bool cancelled; /* nobody waits for it any more */

    bool compare; /* else a snapshot */
    struct against against;
    bool difference; /* its picture is wanted, in `codec` */
    unsigned frames; /* timed */
    bool moving;
    json_t *figures; /* the comparison's result; owned */

    _Atomic int stage;
    _Atomic int permille;        /* of the stage; < 0: not known */
    _Atomic uint64_t told_us;    /* when `told` was last called for permille alone */
    void (*told)(void *context); /* any thread, after stage or permille changed; at most each 100 ms for permille */
    void *context;
};

/* Takes a reference to `scene`. NULL when memory is out. */
struct render_request *render_request_create(struct scene_entry *scene);
void render_request_destroy(struct render_request *request); /* accepts NULL */

/* `done` in [0, 1], < 0: not known. Any thread. */
void render_request_tell(struct render_request *request, enum request_stage stage, double done);
