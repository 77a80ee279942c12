/* Common light fitting: which maps a light needs and what they see. Every map system gets the same answer.
 *
 * tight: fitted to the casters, whatever the camera sees, so that a moving camera rebuilds nothing. A directional light has one map; a point or
 * spot light one perspective map if all casters (of a spot: those in its cone) lie within 120 degrees, else those cube faces that hold
 * casters. cube: always cube faces; for a directional light a square around the bounding sphere. Receivers outside the maps are lit.
 * A point or spot light more than 8192 scene radii away is fitted as the directional light it is, for all that single precision can tell.
 * A planar instance with everything else on the light's side of it casts nothing. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/shadow.h"

struct error;

/* Boxes around groups of vertices of each mesh: tight enough to fit maps by, few enough to do so every frame. */
struct fit_geometry {
    const struct scene *scene;
    struct fit_box {
        float min[3], max[3];
    } * boxes;
    size_t *first_box; /* per mesh, mesh_count + 1 entries */
};

bool fit_geometry_init(struct fit_geometry *g, const struct scene *scene, struct error *err);
void fit_geometry_finish(struct fit_geometry *g);

/* `casters`: room for instance_count entries, owned by the caller; `out` points into it. */
void shadow_fit_compute(const struct fit_geometry *g, const struct light *light, uint32_t size, bool cube, uint32_t *casters,
                        struct shadow_fit *out);
