/* The scene as plain triangles in an Embree tree: fp32, robust, packets, both producers' fast path on a machine without a GPU.
 * Scene space rounded to fp32. Thread-safe once created. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"
#include "scene/view.h"

struct error;
struct job_pool;
struct pixel;
struct tracer;

/* `scene` must outlive it. Threads bounds the tree build. ERROR_TRY_AGAIN when memory is out. */
struct tracer *tracer_create(const struct scene *scene, unsigned threads, struct error *err);
void tracer_destroy(struct tracer *t);
size_t tracer_bytes(const struct tracer *t);

/* The camera pass, traced: for every pixel the drawn-triangle id visible at its centre (SCENE_NONE: none), and what is to be known of the
 * surface there, textures apart. Obeys double_sided, holes (material_alpha), view.near and view.far. Both width * height; pixels may be
 * NULL. */
void tracer_camera(const struct tracer *t, const struct view *view, struct job_pool *pool, uint32_t *ids, struct pixel *pixels);

/* A light's depth map, traced: the nearest depth along view.forward at each texel centre over `casters` only (ascending instance
 * indices; NULL: all), INFINITY where there is none; every triangle counts, whichever side it shows; holes are holes.
 * ids may be NULL. */
void tracer_light(const struct tracer *t, const struct view *view, const uint32_t *casters, size_t caster_count,
                  struct job_pool *pool, float *depths, uint32_t *ids);

/* tracer_light() for `count` small views of one size, one after the other on the calling thread: for callers that are jobs
 * themselves. depths (may be NULL) and ids: count * width * height. */
void tracer_light_ids(const struct tracer *t, const struct view *views, size_t count, const uint32_t *casters,
                      size_t caster_count, float *depths, uint32_t *ids);

/* The same for `count` views at once; those of view i start at [i * stride], stride >= width * height of each. */
void tracer_light_views(const struct tracer *t, const struct view *views, size_t count, size_t stride, const uint32_t *casters,
                        size_t caster_count, struct job_pool *pool, float *depths, uint32_t *ids);

/* The speed baseline. Ids as tracer_camera() wrote them; visibility: 1 lit, 0 shadowed or no receiver. */
void tracer_shadow_point(const struct tracer *t, const struct view *view, const struct light *light, const uint32_t *ids,
                         struct job_pool *pool, float *visibility);
/* 32 primary and 32 shadow rays a pixel (view_samples32). receivers and lit: one mask a pixel; either may be NULL. */
void tracer_shadow_samples32(const struct tracer *t, const struct view *view, const struct light *light, struct job_pool *pool,
                             uint32_t *receivers, uint32_t *lit);

/* *arealight*: the fraction of `rays` fixed points of the light's disc (TRACER_AREA_RAYS_MAX at most) that each receiver sees; docs/truth.md.
 * ids and receiver (1: counts) as reference_point() has them; visibility: 0 where there is no receiver. `report`, which may be NULL, is called
 * now and then from any worker with done in [0, 1]; false stops early, and so does this. */
bool tracer_shadow_area(const struct tracer *t, const struct view *view, const struct light *light, double radius, unsigned rays,
                        const uint32_t *ids, const uint8_t *receiver, struct job_pool *pool,
                        bool (*report)(void *context, double done), void *context, float *visibility);
enum { TRACER_AREA_RAYS_MAX = 4096 };

/* Radius of the disc when nobody said: the light's own, else 2 % of its distance from the scene's centre; for a directional light in degrees
 * as seen from the receiver, 0.5 when it has none. */
double tracer_area_radius(const struct scene *scene, const struct light *light);
