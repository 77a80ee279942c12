/* Masks as bits: which texels of a material's texture are solid, and where on the texture a triangle's points lie. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"

struct hole_mask {
    uint32_t width, height; /* texels */
    uint32_t row;           /* words */
    enum wrap_mode wrap_s, wrap_t;
    uint32_t *solid; /* bit x % 32 of word y * row + x / 32; NULL: material_alpha() is to be asked */
};

struct hole_masks {
    struct hole_mask *of_material;
    size_t count;
};

/* False when memory is out; hole_masks_finish() in any case. */
bool hole_masks_init(struct hole_masks *m, const struct scene *scene);
void hole_masks_finish(struct hole_masks *m);
size_t hole_masks_bytes(const struct scene *scene);

static inline bool hole_mask_at(const struct hole_mask *m, uint32_t x, uint32_t y)
{
    return m->solid[y * m->row + (x >> 5)] >> (x & 31) & 1;
}

/* Where a triangle's point that weighs its corners 1 - u - v, u, v lies on its mask, in texels, before wrapping:
 * s[0] + u s[1] + v s[2], and t alike.
 *
 * trace/hole.h and material_alpha() round: the coordinates to single precision, two products and two sums of the transform, the product with
 * the size; each adds at most 2^-24 of A = size (|row 0| c_u + |row 1| c_v + |offset|), c the largest of the corners' coordinates, as far as the
 * weights are within 1/4 of [0, 1]: 6.25 x 2^-24 A together. `error` is 2^-21 A. Where weights are off by w in all, the position is by w
 * `range`. */
struct hole_map {
    const struct hole_mask *mask; /* NULL: has none, or its coordinates are too large for that */
    double s[3], t[3];
    double s_error, t_error, s_range, t_range;
};

void hole_map_make(struct hole_map *map, const struct hole_masks *masks, const struct scene *scene, uint32_t id);
