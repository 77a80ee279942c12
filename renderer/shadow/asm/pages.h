/* What the pages hold: for each texel the depth of the nearest surface (encoded as in shaders/maps.glsl) and which triangle it is. Made by the
 * rasterizer or, in shadow_input.trace_maps, by tracing. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "draw/draw_view.h"
#include "gl/texture.h"
#include "shadow/asm/tree.h"

struct asm_pages {
    struct gl_texture depths; /* D32F, ASM_COLUMNS slots wide; for shaders, as what follows */
    struct gl_texture ids;    /* R32UI, likewise */
    struct gl_target target;
    struct draw_view draw;
    float *kept_depths; /* for the CPU instead: a slot's texels after the other's, row by row; owned */
    uint32_t *kept_ids;
    size_t kept_bytes;    /* of both */
    float *traced_depths; /* on the way to either */
    uint32_t *traced_ids;
};

/* `slots`: a multiple of ASM_COLUMNS. gl: NULL for pages that the CPU looks up; these are traced. */
bool asm_pages_init(struct asm_pages *p, struct gl_context *gl, uint32_t slots, struct error *err);
void asm_pages_finish(struct asm_pages *p);
/* Bytes a slot takes; that all take beside their slots; that all take now. */
size_t asm_pages_slot_bytes(void);
size_t asm_pages_fixed_bytes(void);
size_t asm_pages_bytes(const struct asm_pages *p);

struct shadow_input;

/* Fills the roots. */
bool asm_pages_fill_roots(struct asm_pages *p, const struct asm_tree *tree, const struct shadow_input *in, struct error *err);
/* Fills the pages `slots`. */
bool asm_pages_fill(struct asm_pages *p, const struct asm_tree *tree, const uint32_t *slots, size_t count,
                    const struct shadow_input *in, struct error *err);
