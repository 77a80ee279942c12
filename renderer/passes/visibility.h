/* The visibility buffer: what a shadow system makes of each light and lighting reads, one number in [0, 1] a pixel; 0 where there is no
 * receiver. It lies on the device; or, while all who make and read it work on the CPU, only there. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gl/texture.h"
#include "scene/scene.h"

struct error;
struct gl_context;
struct tiles;

#define VISIBILITY_LAYERS_MAX 16

/* One light's on the CPU. */
struct visibility_layer {
    float *values; /* one a pixel; what lies outside the rows that hold surfaces says nothing */
    bool filled;   /* by the system, in place of the device's */
};

struct visibility {
    struct gl_texture texture; /* R32F, a layer a light */
    struct gl_target target;
    float *memory; /* of all layers */
    size_t room;   /* floats */
    struct visibility_layer layers[VISIBILITY_LAYERS_MAX];
    uint32_t top, bottom; /* picture rows that hold surfaces */
};

/* For a picture of width x height with surfaces in `tiles`. keep: layers get room on the CPU, else their values are NULL. */
bool visibility_begin(struct visibility *v, struct gl_context *gl, uint32_t width, uint32_t height, uint32_t layers,
                      const struct tiles *tiles, bool keep, struct error *err);

/* Binds the device's layer as the framebuffer, cleared. */
void visibility_bind(struct visibility *v, uint32_t layer);

/* Brings to the CPU what a picture that is kept there has on the device; waits for it. */
bool visibility_need_values(struct visibility *v, struct gl_context *gl, struct error *err);

/* Brings to the device what was filled on the CPU. */
bool visibility_need_texture(struct visibility *v, struct gl_context *gl, struct error *err);

/* One value a pixel to `out`, waiting for the device where they lie there. False: no such layer, or the device failed. */
bool visibility_read(struct visibility *v, struct gl_context *gl, uint32_t layer, float *out);

void visibility_finish(struct visibility *v);
