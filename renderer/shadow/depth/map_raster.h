/* A depth map rasterized on the CPU's job pool, at texel centres as GL does: a software GL device does a draw's vertices on one thread, and a
 * map that is compared on the CPU would have to be read back. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/geometry/light_mesh.h"

struct depth_kernel;

enum { RASTER_ROWS = 32 }; /* texel rows a band: one job's share of the map */

struct map_raster {
    struct light_mesh mesh;
    size_t *first;     /* a part: the number of its first triangle; and the end */
    uint16_t *ranges;  /* a triangle: first band and the one after its last */
    uint32_t *counts;  /* a band and chunk of triangles: entries; then where they begin */
    uint32_t *entries; /* three vertices each, band after band */
    size_t part_room, triangle_room, count_room, entry_room;
    uint32_t chunks, bands;
};

/* The vertices of a band's triangles, for the kernels (depth_plain.c, depth_avx*.c). */
struct raster_job {
    const struct map_raster *raster;
    float *texels;
    uint32_t side;
    float scale; /* of nearness to what a texel holds (shaders/maps.glsl) */
};

/* Fills texels (side x side of `view`) from `casters`, whichever way their triangles turn; *done: false where it cannot, for holes or for
 * triangles that reach from behind the light or from far off into the map: nothing was written. May be called again. ERROR_TRY_AGAIN when
 * memory is out. */
bool map_raster_draw(struct map_raster *r, const struct scene *scene, const struct view *view, const uint32_t *casters,
                     size_t caster_count, const struct depth_kernel *kernel, struct job_pool *pool, float *texels, bool *done,
                     struct error *err);
void map_raster_finish(struct map_raster *r);
size_t map_raster_bytes(const struct map_raster *r);
