/* Lights as users give them: `--light 'point position=0,2,0 intensity=100'`, and the same keys on the wire.
 * World coordinates, scene units, degrees, candela (point, spot) and lux (directional), as KHR_lights_punctual. What is not given
 * takes that extension's default. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "scene/scene.h"

struct error;

/* "directional", "point", "spot" in the order of enum light_kind; ended by NULL. */
extern const char *const light_kind_names[];

/* A light of `kind` with the extension's defaults: white, intensity 1, at the origin, shining along -Z, cone of 0 to 45 degrees. */
struct light light_default(enum light_kind kind);

/* How many numbers `key` takes (1 or 3) for a light of `kind`; 0 with an error that lists the accepted keys when it takes none. */
size_t light_key_values(enum light_kind kind, const char *key, struct error *err);

/* Sets one property from its numbers (light_key_values() of them), in the units above. ERROR_USAGE names the range. */
bool light_set(struct light *light, const char *key, const double *values, struct error *err);

/* What depends on two properties: inner < outer. To be called after the last light_set(). */
bool light_check(const struct light *light, struct error *err);

/* "KIND key=value ...", checked. World coordinates. ERROR_USAGE. */
bool light_parse(const char *text, struct light *out, struct error *err);

/* From world to scene space. */
struct light light_from_world(const struct scene *scene, const struct light *light);
