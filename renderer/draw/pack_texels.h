/* All images of a scene in one run of texels, each with its mip levels: deferred shading picks materials pixel by pixel, and OpenGL 4.5 core
 * has no bindless textures. Level 0 is the image as decoded, texel for texel, since holes are cut by it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct scene;

struct packed_texels {
    uint32_t (*textures)[4]; /* per texture, as UNIT_TEXTURES in shaders/blocks.h; owned */
    uint32_t *texels;        /* RGBA8, owned */
    size_t texel_count;
};

/* ERROR_TRY_AGAIN when more than `max_texels` would be needed. Call packed_texels_finish() after success. */
bool pack_texels(struct packed_texels *out, const struct scene *scene, size_t max_texels, struct error *err);
void packed_texels_finish(struct packed_texels *p);
