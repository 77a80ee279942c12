#include <math.h>

#include "scene/scene.h"

/* Beyond this a coordinate has no fraction left in fp32; it also keeps the integer arithmetic below from overflowing. */
#define TEXEL_LIMIT 1073741824.0f

uint32_t texture_wrap(int64_t texel, uint32_t size, enum wrap_mode wrap)
{
    int64_t n = size, period = wrap == WRAP_MIRRORED_REPEAT ? 2 * n : n;
    if (wrap == WRAP_CLAMP_TO_EDGE)
        return (uint32_t)(texel < 0 ? 0 : texel >= n ? n - 1 : texel);
    int64_t within = texel % period;
    within += within < 0 ? period : 0;
    return (uint32_t)(within < n ? within : 2 * n - 1 - within);
}

/* GL_NEAREST (OpenGL 4.5, 8.14.2): floor(u * size), then wrapped as an integer. NaN counts as -2^30. */
static uint32_t nearest_texel(float u, uint32_t size, enum wrap_mode wrap)
{
    float position = floorf(u * (float)size);
    if (!(position > -TEXEL_LIMIT))
        position = -TEXEL_LIMIT;
    if (position > TEXEL_LIMIT)
        position = TEXEL_LIMIT;
    return texture_wrap((int64_t)position, size, wrap);
}

float material_alpha(const struct scene *scene, const struct material *material, const float uv[2], float vertex_alpha)
{
    const struct texture_use *use = &material->base_color_texture;
    if (use->texture == SCENE_NONE)
        return material->base_color[3] * vertex_alpha;
    const struct texture *texture = &scene->textures[use->texture];
    const struct image *image = &scene->images[texture->image];
    float u = use->transform[0][0] * uv[0] + use->transform[0][1] * uv[1] + use->transform[0][2];
    float v = use->transform[1][0] * uv[0] + use->transform[1][1] * uv[1] + use->transform[1][2];
    size_t x = nearest_texel(u, image->width, texture->wrap_s);
    size_t y = nearest_texel(v, image->height, texture->wrap_t);
    return material_texel_alpha(material, vertex_alpha, image->rgba[4 * (y * image->width + x) + 3]);
}
