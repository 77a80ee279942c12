/* Which producer makes an id buffer or a depth map: the rasterizer or the ray tracer. A model, not a stop-watch: the same command gives the
 * same picture, and a small scene builds no tree. On a GPU always the rasterizer. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct draw_scene;

/* The camera's picture of `pixels`. */
bool producer_traces_camera(const struct draw_scene *scene, size_t pixels);

/* Pixels against depth maps: on the CPU's job pool rather than by shaders. */
bool producer_resolves_on_cpu(const struct draw_scene *scene);

/* A light's map of `texels`. */
bool producer_traces_map(const struct draw_scene *scene, size_t texels);

/* The same where the choice is between the tracer and the CPU's own rasterizer (shadow/depth/map_raster.h). */
bool producer_traces_map_on_cpu(const struct draw_scene *scene, size_t texels);
