/* soft's passes on the CPU (depth_pass.h): the term of every pixel, then the blur along x and y of those that have one. The formulas are those of
 * shaders/soft_term.frag and shaders/soft_blur.frag. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/depth/depth_pass.h"
#include "shadow/depth/map_bounds.h"

struct soft_pass {
    uint32_t stride; /* of rows in a picture's arrays: the width, or little more */
    uint32_t *terms; /* a pixel, blurred along x: shaders/soft_term.glsl; owned */
    float *sigmas;   /* standard deviations along y, pixels, where `blurs`; owned */
    uint8_t *blurs;  /* of eight pixels, whether any is blurred; owned */
    size_t pixel_room;
    uint32_t *band_terms; /* of DEPTH_ROWS rows at work, for each worker; owned */
    float *band_sigmas;
    size_t band_room;
    struct map_bounds bounds;
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

/* From maps prepared with in->resolve_on_cpu. `block`: as far as any blur may reach, texels: a power of two, 8 to
 * BOUND_LARGEST. */
bool soft_pass_prepare(struct soft_pass *s, const struct light_maps *maps, const struct shadow_input *in, uint32_t block,
                       struct error *err);
bool soft_pass_resolve(struct soft_pass *s, const struct light_maps *maps, const struct shadow_input *in,
                       const struct soft_settings *settings, struct error *err);
void soft_pass_finish(struct soft_pass *s);
size_t soft_pass_bytes(const struct soft_pass *s);
