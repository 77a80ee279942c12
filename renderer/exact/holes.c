#include "exact/holes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Beyond this (in texels) bounds on rounding would not mean much. */
#define FARTHEST 0x1p28

static const struct image *masking_image(const struct scene *scene, const struct material *m)
{
    uint32_t texture = m->base_color_texture.texture;
    return material_has_holes(m) && texture != SCENE_NONE ? &scene->images[scene->textures[texture].image] : NULL;
}

static uint32_t words_of_row(const struct image *image) { return (image->width + 31) / 32; }

size_t hole_masks_bytes(const struct scene *scene)
{
    size_t bytes = scene->material_count * sizeof(struct hole_mask);
    for (size_t i = 0; i < scene->material_count; i++) {
        const struct image *image = masking_image(scene, &scene->materials[i]);
        bytes += image ? (size_t)words_of_row(image) * image->height * sizeof(uint32_t) : 0;
    }
    return bytes;
}

static void fill(struct hole_mask *mask, const struct material *m, const struct image *image)
{
    bool solid[256];
    for (int i = 0; i < 256; i++)
        solid[i] = material_texel_alpha(m, 1, (uint8_t)i) >= m->alpha_cutoff;
    for (size_t y = 0; y < image->height; y++)
        for (size_t x = 0; x < image->width; x++)
            mask->solid[y * mask->row + x / 32] |= (uint32_t)solid[image->rgba[4 * (y * image->width + x) + 3]] << x % 32;
}

bool hole_masks_init(struct hole_masks *m, const struct scene *scene)
{
    *m = (struct hole_masks){.of_material = calloc(scene->material_count + 1, sizeof *m->of_material),
                             .count = scene->material_count};
    for (size_t i = 0; m->of_material && i < m->count; i++) {
        const struct material *material = &scene->materials[i];
        const struct image *image = masking_image(scene, material);
        struct hole_mask *mask = &m->of_material[i];
        if (!image)
            continue;
        const struct texture *texture = &scene->textures[material->base_color_texture.texture];
        *mask = (struct hole_mask){image->width, image->height, words_of_row(image), texture->wrap_s, texture->wrap_t, NULL};
        mask->solid = calloc((size_t)mask->row * mask->height, sizeof *mask->solid);
        if (!mask->solid)
            return false;
        fill(mask, material, image);
    }
    return m->of_material != NULL;
}

void hole_masks_finish(struct hole_masks *m)
{
    for (size_t i = 0; m->of_material && i < m->count; i++)
        free(m->of_material[i].solid);
    free(m->of_material);
    memset(m, 0, sizeof *m);
}

/* One coordinate: `row` of the transform, the corners' raw coordinates, the texture's size. False when it is too large. */
static bool along(const float row[3], const float *const corners[3], uint32_t size, double out[3], double *error, double *range)
{
    double c[3], most[2] = {0, 0};
    for (int i = 0; i < 3; i++) {
        c[i] = size * ((double)row[0] * (double)corners[i][0] + (double)row[1] * (double)corners[i][1] + (double)row[2]);
        most[0] = fmax(most[0], fabs((double)corners[i][0]));
        most[1] = fmax(most[1], fabs((double)corners[i][1]));
    }
    double all = size * (fabs((double)row[0]) * most[0] + fabs((double)row[1]) * most[1] + fabs((double)row[2]));
    out[0] = c[0], out[1] = c[1] - c[0], out[2] = c[2] - c[0];
    *error = 0x1p-21 * all + 1e-30 * size;
    *range = fabs(out[1]) + fabs(out[2]) + 0x1p-40 * all;
    return all < FARTHEST; /* false for NaN */
}

void hole_map_make(struct hole_map *map, const struct hole_masks *masks, const struct scene *scene, uint32_t id)
{
    const struct instance *instance = &scene->instances[scene_instance_of(scene, id)];
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    const struct texture_use *use = &scene->materials[mesh->material].base_color_texture;
    const struct hole_mask *mask = &masks->of_material[mesh->material];
    const float *uv[3];
    map->mask = NULL;
    if (!mask->solid || mesh->first_texcoord[use->texcoord] == SCENE_NONE || mesh->first_color != SCENE_NONE)
        return;
    const uint32_t *corner = scene->indices + mesh->first_index + (size_t)(id - instance->first_triangle) * 3;
    for (int i = 0; i < 3; i++)
        uv[i] = scene->texcoords[mesh->first_texcoord[use->texcoord] + corner[i]];
    if (along(use->transform[0], uv, mask->width, map->s, &map->s_error, &map->s_range) &&
        along(use->transform[1], uv, mask->height, map->t, &map->t_error, &map->t_range))
        map->mask = mask;
}
