/* Cameras as users choose them: one of the scene's, the one that frames it, or a look-at in world coordinates. */
#pragma once

#include <stdbool.h>

#include "scene/scene.h"

struct error;

enum camera_source {
    CAMERA_FIRST, /* the scene's first, or the framing one when it has none */
    CAMERA_NAMED, /* by name, index or "auto" */
    CAMERA_LOOK_AT,
};

struct camera_choice {
    enum camera_source source;
    const char *name;             /* CAMERA_NAMED; borrowed */
    struct dvec3 eye, target, up; /* CAMERA_LOOK_AT; world */
    double fov_deg;               /* CAMERA_LOOK_AT; full vertical angle, FOV_MIN_DEG..FOV_MAX_DEG */
    double height; /* CAMERA_LOOK_AT; orthographic where over 0: of what is seen, scene units; `fov_deg` then does not matter */
};

#define FOV_MIN_DEG     0.01
#define FOV_MAX_DEG     179.0
#define FOV_DEFAULT_DEG 45.0
#define ORTHO_MIN       1e-9
#define ORTHO_MAX       1e15

/* The scene's first camera. up = +Y and the default field of view for whoever makes it a look-at. */
struct camera_choice camera_choice_default(void);

/* The chosen camera in scene space; `aspect` = width / height of the picture. ERROR_USAGE lists the scene's cameras. */
bool camera_choose(const struct scene *scene, const struct camera_choice *choice, double aspect, struct camera *out,
                   struct error *err);

/* The look-at part alone, without a scene's origin: checks finite, eye != target, up not along the view, the ranges of angle and
 * height. */
bool camera_check_look_at(const struct camera_choice *choice, struct error *err);
