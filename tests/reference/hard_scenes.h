/* Small scenes that rounding gets wrong. */
#pragma once

#include <stddef.h>

#include "made_scene.h"

struct hard_scene {
    const char *name;
    struct scene *(*make)(void); /* finished */
    struct dvec3 eye, target;    /* of a fitting camera */
    struct dvec3 light;
    bool grid; /* for an orthographic camera whose picture positions fall on the scene's integers */
};

extern const struct hard_scene hard_scenes[];
extern const size_t hard_scene_count;
