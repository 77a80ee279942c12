/* The camera pass: two producers of the same id buffer. On a software GL device tracing a dense mesh is several times faster than
 * rasterizing it; on a GPU it never is. */
#pragma once

#include <stdbool.h>

struct draw_scene;
struct error;
struct gbuffer;
struct job_pool;
struct tracer;

/* Fills ids by rasterizing. Receivers are left to camera_receivers(). */
bool camera_rasterize(struct gbuffer *g, struct draw_scene *scene, struct error *err);

/* Fills ids and receivers by tracing. */
bool camera_trace(struct gbuffer *g, struct draw_scene *scene, const struct tracer *tracer, struct job_pool *pool, struct error *err);

/* Fills receivers from ids; nothing to do after camera_trace(). */
bool camera_receivers(struct gbuffer *g, struct draw_scene *scene, struct error *err);
