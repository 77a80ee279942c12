/* Where a triangle is a hole. */
#pragma once

#include "scene/scene.h"

/* True when `triangle` (0-based in the instance's mesh) is solid at the point that weighs its corners 1 - u - v, u, v: the texture
 * coordinates are (w0 * c0 + w1 * c1) + w2 * c2 in double, rounded to float, and so is the vertex alpha. */
static inline bool hole_is_solid(const struct scene *scene, uint32_t instance, uint32_t triangle, double u, double v)
{
    const struct mesh *mesh = &scene->meshes[scene->instances[instance].mesh];
    const struct material *material = &scene->materials[mesh->material];
    const uint32_t *corner = scene->indices + mesh->first_index + (size_t)triangle * 3;
    double w[3] = {1 - u - v, u, v};
    const struct texture_use *use = &material->base_color_texture;
    uint32_t first = use->texture == SCENE_NONE ? SCENE_NONE : mesh->first_texcoord[use->texcoord];
    float uv[2] = {0, 0}, alpha = 1;
    if (first != SCENE_NONE) {
        const float(*c)[2] = (const float(*)[2])scene->texcoords + first;
        for (int i = 0; i < 2; i++)
            uv[i] = (float)((w[0] * c[corner[0]][i] + w[1] * c[corner[1]][i]) + w[2] * c[corner[2]][i]);
    }
    if (mesh->first_color != SCENE_NONE) {
        const float(*c)[4] = (const float(*)[4])scene->colors + mesh->first_color;
        alpha = (float)((w[0] * c[corner[0]][3] + w[1] * c[corner[1]][3]) + w[2] * c[corner[2]][3]);
    }
    return material_alpha(scene, material, uv, alpha) >= material->alpha_cutoff;
}
