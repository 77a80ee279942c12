/* A light's geometry maps, and the pass from pixels to visibility that rgsm, spsm and coverage share: every receiver is put on its map; what the
 * texel's nearest depth cannot tell to be lit, the system decides.
 *
 * On the CPU, on the job pool: where the camera is traced, ids and surfaces are there already; else they are read back. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/geometry/geometry_map.h"
#include "shadow/geometry/geometry_points.h"
#include "shadow/shadow.h"

struct geometry_maps {
    struct geometry_map maps[SHADOW_MAPS_MAX];
    unsigned count;
    struct geometry_points points; /* of the picture at hand */
};

/* Sets the visibility of points of one tile that are dark to 0. They are those that their texels' nearest depths do not tell to be lit. On several
 * threads, each tile on one unless it holds very many. `state`: the system's. */
typedef void geometry_decide(void *state, const struct geometry_map *m, const struct map_point *points, size_t count,
                             const double *params, float *visibility);

bool geometry_maps_prepare(struct geometry_maps *g, const struct shadow_input *in, struct error *err);
bool geometry_maps_resolve(struct geometry_maps *g, const struct shadow_input *in, geometry_decide *decide, void *state,
                           struct error *err);
void geometry_maps_finish(struct geometry_maps *g);
size_t geometry_maps_bytes(const struct geometry_maps *g);

/* Whether something at nearness `occluder` lies before a point at `n`: nearer by more than rounding explains. */
static inline bool geometry_before(const struct geometry_map *m, float occluder, float n)
{
    return occluder > n + 0x1p-20f * (occluder > 0 ? occluder : -occluder) + m->mesh.rounding;
}

/* What a triangle says about a point. */
enum geometry_verdict {
    GEOMETRY_ELSEWHERE, /* its projection does not hold the point, or has a hole there */
    GEOMETRY_BEHIND,    /* holds it, and is not before it */
    GEOMETRY_OWN,       /* is the point's own triangle */
    GEOMETRY_BEFORE,    /* shadows it */
};
