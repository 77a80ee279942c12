/* Cameras, lights and exposure between JSON and the renderer's structs. World coordinates, degrees, candela and lux. */
#pragma once

#include <stdbool.h>

#include <jansson.h>

#include "cameras.h"
#include "renderer.h"

struct error;

#define WIRE_CAMERA_NAME_MAX 64

/* A name, an index or {eye, target, up, fov or height}. `name` is what out->name will point to. */
bool wire_read_camera(const json_t *value, struct camera_choice *out, char name[WIRE_CAMERA_NAME_MAX], struct error *err);

/* {kind, and --light's keys}. `light` is the light to change: keys not given stay, unless the kind changes; NULL for a new one, whose
 * kind is required. Scene space in and out. */
bool wire_read_light(const struct scene *scene, const json_t *value, const struct light *light, struct light *out,
                     struct error *err);
/* An array of new lights; replaces those in `settings`. */
bool wire_read_lights(const struct scene *scene, const json_t *value, struct render_settings *settings, struct error *err);

/* "NAME[:key=value,...]". Errors about one of its parameters say algorithm.KEY: a request has a `size` of its own. */
bool wire_read_algorithm(const char *text, struct render_settings *settings, struct error *err);

/* A number of stops, or "auto". */
bool wire_read_exposure(const json_t *value, struct render_settings *settings, struct error *err);

/* {eye, target, up, fov or height, name} with the target at the scene's depth, for viewers that orbit. */
json_t *wire_camera(const struct scene *scene, const struct camera *camera);
json_t *wire_lights(const struct scene *scene, const struct render_settings *settings);
/* {scene, triangles, drawn_triangles, vertices, bounds, cameras, lights} */
json_t *wire_scene(const char *name, const struct scene *scene);
