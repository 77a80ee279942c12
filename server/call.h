/* A request under way, from its arrival to its answer. Network thread. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include <jansson.h>

struct error;
struct method;
struct scene_entry;
struct server;
struct render_request;

/* What a method's handler returns. */
enum outcome {
    OUTCOME_DONE,   /* *result is the answer */
    OUTCOME_FAILED, /* err says why */
    OUTCOME_NO_VIEW,
    OUTCOME_SCENE, /* run again when call->scene has been loaded */
    OUTCOME_LATER, /* answered when its picture is ready */
};

struct call {
    struct call *link;
    uint64_t session;
    bool http;      /* answered with a picture or a status */
    json_t *id;     /* NULL: a notification, or HTTP */
    json_t *params; /* may be NULL */
    const struct method *method;
    struct scene_entry *scene;      /* waited for; one reference */
    struct render_request *request; /* under way */
    bool told;                      /* $/progress: what was told last follows */
    int stage, permille;
    char allow_origin[256]; /* HTTP: "" none */
};
