/* The camera pass: two producers of the same id buffer. On a software GL device tracing a dense mesh is several times faster than
 * rasterizing it; on a GPU it never is. */
#pragma once

#include <stdbool.h>

struct draw_scene;
struct error;
struct gbuffer;
struct job_pool;
struct tracer;

/* Fills ids by rasterizing. */
bool camera_rasterize(struct gbuffer *g, struct draw_scene *scene, struct error *err);

/* Fills ids by tracing, and the pixels too where the scene is plain (draw_scene.h). */
bool camera_trace(struct gbuffer *g, struct draw_scene *scene, const struct tracer *tracer, struct job_pool *pool,
                  struct error *err);

/* Fills pixels and emission from ids, unless they are there already. */
bool camera_surfaces(struct gbuffer *g, struct draw_scene *scene, struct error *err);
