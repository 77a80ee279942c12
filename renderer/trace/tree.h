/* The tracer's insides, shared by the files of this folder. */
#pragma once

#include <embree3/rtcore.h>
#include <pthread.h>
#include <stdatomic.h>

#include "trace/tracer.h"

struct caster_cache;
struct surface;

/* Which faces the camera sees, by the side that cross(v1 - v0, v2 - v0) points to. */
enum front { FRONT_BOTH, FRONT_CCW, FRONT_CW };

struct tracer {
    const struct scene *scene;
    RTCDevice device;
    RTCScene all;
    RTCGeometry *geometries; /* one an instance, geomID = instance index; NULL where it has no triangles */
    float (*vertices)[3];    /* every instance's own, scene space */
    size_t *first_vertex;    /* of each instance */
    size_t vertex_count;
    uint8_t *front;           /* of each instance: enum front */
    struct surface *surfaces; /* of each instance */
    struct caster_cache *casters;
    atomic_size_t embree_bytes;
};

/* Embree's accessors of packets of any width are C++ only. The layout they have: member k of lane i at [k * n + i] (rtcore_ray.h). */
enum ray_member { RAY_DIR_X = 4, RAY_DIR_Y, RAY_DIR_Z, RAY_ID = 10 };
enum hit_member { HIT_NG_X, HIT_NG_Y, HIT_NG_Z, HIT_U, HIT_V, HIT_PRIM_ID, HIT_GEOM_ID };

static inline float ray_float(const struct RTCRayN *ray, enum ray_member member, unsigned n, unsigned i)
{
    return ((const float *)ray)[(unsigned)member * n + i];
}
static inline unsigned ray_id(const struct RTCRayN *ray, unsigned n, unsigned i)
{
    return ((const unsigned *)ray)[RAY_ID * n + i];
}
static inline float hit_float(const struct RTCHitN *hit, enum hit_member member, unsigned n, unsigned i)
{
    return ((const float *)hit)[(unsigned)member * n + i];
}
static inline unsigned hit_id(const struct RTCHitN *hit, enum hit_member member, unsigned n, unsigned i)
{
    return ((const unsigned *)hit)[(unsigned)member * n + i];
}

/* The tree over `casters` only, built when first asked for; t->all when `casters` is NULL. NULL when memory is out. */
RTCScene tree_of_casters(const struct tracer *t, const uint32_t *casters, size_t count);

struct caster_cache *caster_cache_create(void);
void caster_cache_destroy(struct caster_cache *cache); /* accepts NULL */
