/* A light's geometry maps, and the pass from pixels to visibility that rgsm, spsm and coverage share: every receiver is put on its map; what the
 * texel's nearest depth cannot tell to be lit, the system decides.
 *
 * On the CPU, on the job pool: where the camera is traced, ids and surfaces are there already; else they are read back. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/geometry_map.h"
#include "shadow/shadow.h"

struct pixel;

struct geometry_maps {
    struct geometry_map maps[SHADOW_MAPS_MAX];
    unsigned count;
};

/* A receiver on a map. */
struct map_point {
    float x, y, n; /* as in light_mesh.h */
    uint32_t id;   /* its triangle, drawn id */
    size_t at;     /* its texel, in cells and notes */
};

/* True: lit. Called for points that are not known to be lit by the texel's nearest depth. `state`: the system's; `hint`: a thread's own. */
typedef bool geometry_decide(void *state, const struct geometry_map *m, const struct map_point *p, const double *params,
                             uint32_t *hint);

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

/* What triangle `id` (MAP_OFF_EDGE allowed) says about the point. */
enum geometry_verdict {
    GEOMETRY_ELSEWHERE, /* its projection does not hold the point, or has a hole there */
    GEOMETRY_BEHIND,    /* holds it, and is not before it */
    GEOMETRY_OWN,       /* is the point's own triangle */
    GEOMETRY_BEFORE,    /* shadows it */
};
/* Whether any corner of triangle `id` lies before the point: if none does, nothing of it can. */
static inline bool geometry_may_shadow(const struct geometry_map *m, uint32_t id, const struct map_point *p, uint32_t *hint)
{
    struct light_triangle t = light_part_triangle(light_mesh_part(&m->mesh, id, hint), id);
    return light_triangle_wild(&t) || geometry_before(m, t.corner[0]->n, p->n) || geometry_before(m, t.corner[1]->n, p->n) ||
           geometry_before(m, t.corner[2]->n, p->n);
}
enum geometry_verdict geometry_ask(const struct geometry_map *m, uint32_t id, const struct map_point *p, uint32_t *hint);
