/* soft's passes on the CPU (depth_pass.h): the term of every pixel, then the blur along x and y of those that have one. The formulas are those of
 * shaders/soft_term.frag and shaders/soft_blur.frag. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/depth_pass.h"

struct soft_pass {
    uint32_t *terms, *blurred; /* a pixel: shaders/soft_term.glsl; owned */
    float *sigmas[2];          /* standard deviations along x and y, pixels; owned */
    size_t pixel_room;
    float *ranges; /* what struct map_ranges holds: two floats a block, map after map; owned */
    float *own;    /* the same of each block alone */
    size_t range_room;
    uint32_t block, blocks; /* side of a block, texels; blocks a side of a map */
};

/* What the pass is told besides its maps. */
struct soft_settings {
    float radius;          /* of the light, as soft_light.x (shaders/blocks.h) */
    float near, far, lift; /* parameters */
};

struct soft_job {
    struct depth_job depth;
    struct soft_settings settings;
    struct soft_pass *pass;
    bool parallel; /* the camera */
    float grain;   /* a pixel's size; relative to the depth in perspective */
};

/* From maps prepared with in->resolve_on_cpu. `block`: a power of two, 4 to 64. */
bool soft_pass_prepare(struct soft_pass *s, const struct light_maps *maps, const struct shadow_input *in, uint32_t block,
                       struct error *err);
bool soft_pass_resolve(struct soft_pass *s, const struct light_maps *maps, const struct shadow_input *in,
                       const struct soft_settings *settings, struct error *err);
void soft_pass_finish(struct soft_pass *s);
size_t soft_pass_bytes(const struct soft_pass *s);
