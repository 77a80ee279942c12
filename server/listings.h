/* What there is to choose from, as JSON: for `gnomon list`, `gnomon check` and the wire. All return new objects, NULL when memory is out. */
#pragma once

#include <jansson.h>

#include "renderer.h"

enum { DEVICES_MAX = 32 };

json_t *listing_scenes(void); /* [{name, help, params: [{name, help, kind, min, max, default}]}]; names begin with "builtin:" */
json_t *listing_algorithms(
    void); /* [{name, title, help, lights, params: [{name, unit, help, kind, min, max, default, choices, odd}]}] */
json_t *listing_devices(const struct device_info *devices, size_t count);

/* In world coordinates, degrees, the keys of --light. */
json_t *listing_light(const struct scene *scene, const struct light *light);
/* In world coordinates, degrees: {name, kind, eye, forward, up, fov or height, near, far}. */
json_t *listing_camera(const struct scene *scene, const struct camera *camera);
/* [x, y, z] */
json_t *listing_point(struct dvec3 p);
