/* Lighting on the CPU: shaders/lighting.frag's picture of what is shown shaded, for GL devices that are the CPU anyway. Eight pixels go together,
 * compiled once an instruction set (lighting_plain.c, lighting_avx2.c), to the same bits; within one step in 255 of the shader's. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "blocks.h"
#include "scene/pixel.h"
#include "scene/pixel_rays.h"

struct job_pool;

struct lighting_pixels {
    const struct pixel *pixels; /* width * height */
    const float *visibility[LIGHTS_MAX];
    uint32_t *picture; /* RGBA8, red in the low byte */
    uint32_t width, height;
    uint32_t top, bottom; /* the rows that hold surfaces */
    struct pixel_rays rays;
    const struct lights_block *lights; /* as the shader reads them */
    size_t light_count;
    bool aces; /* else no tone curve */
};

/* Fills the whole picture. */
void lighting_pixels_run(const struct lighting_pixels *job, struct job_pool *pool);

typedef void lighting_row(const struct lighting_pixels *job, uint32_t y, uint32_t background);
lighting_row lighting_row_plain;
#ifdef __x86_64__
lighting_row lighting_row_avx2;
#endif
