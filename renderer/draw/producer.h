/* Which producer makes an id buffer or a depth map: the rasterizer or the ray tracer. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct gl_caps;

/* True if tracing `rays` rays through `triangles` triangles is expected to be faster than rasterizing them. A model, not a stop-watch:
 * the same command gives the same picture, and a small scene builds no tree. */
bool producer_prefers_tracing(const struct gl_caps *caps, size_t triangles, size_t rays);
