/* The range of depths round each block of a light's maps: one small texture to look into before many fetches from a large one. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gl/texture.h"

struct error;
struct light_maps;
struct shadow_input;

struct map_ranges {
    /* RG32F arrays, a layer a map, a texel a block: the largest (nearest) and smallest depth texel (encoding: shaders/maps.glsl) of the block
     * and its eight neighbours. */
    struct gl_texture ranges;
    struct gl_texture own; /* the same of the block alone */
    struct gl_target target;
    uint32_t block; /* side, texels */
};

/* From rendered maps. `block`: even. */
bool map_ranges_prepare(struct map_ranges *r, const struct light_maps *maps, const struct shadow_input *in, uint32_t block,
                        struct error *err);
void map_ranges_bind(const struct map_ranges *r);
size_t map_ranges_bytes(const struct map_ranges *r);
void map_ranges_finish(struct map_ranges *r);
