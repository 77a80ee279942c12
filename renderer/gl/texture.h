/* Textures and framebuffers with immutable storage. Zero-initialised = nothing allocated; finish accepts that. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct gl_context;

struct gl_texture {
    unsigned id;
    unsigned format;        /* GL internal format */
    uint32_t width, height; /* texels */
    uint32_t layers;        /* >= 1; every texture is a 2D array or, if `flat`, plain 2D */
    bool flat;
    size_t bytes;
};

/* Makes (or remakes, when anything differs) a 2D texture with nearest filtering, clamped to its edge. */
bool gl_texture_size(struct gl_texture *t, struct gl_context *gl, unsigned format, uint32_t width, uint32_t height,
                     struct error *err);
/* The same as a 2D array of `layers`. */
bool gl_texture_size_layers(struct gl_texture *t, struct gl_context *gl, unsigned format, uint32_t width, uint32_t height,
                            uint32_t layers, struct error *err);
void gl_texture_finish(struct gl_texture *t);
void gl_texture_bind(const struct gl_texture *t, unsigned unit);

/* A framebuffer with up to one colour and one depth attachment. */
struct gl_target {
    unsigned id;
};

/* `color` and `depth` may be NULL, not both; `layer` counts in both unless they are flat. Remembers nothing: attach again after a texture was
 * remade. */
void gl_target_attach(struct gl_target *target, const struct gl_texture *color, const struct gl_texture *depth, uint32_t layer);
/* Two colours, both flat, no depth; `second` may be NULL. */
void gl_target_attach_two(struct gl_target *target, const struct gl_texture *first, const struct gl_texture *second);
void gl_target_bind(const struct gl_target *target, uint32_t width, uint32_t height);
void gl_target_finish(struct gl_target *target);

/* Three vertices that cover the viewport (full_screen.vert). */
void gl_draw_full_screen(void);
