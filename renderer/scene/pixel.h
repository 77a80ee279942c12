/* What a picture knows of the surface at a pixel: everything that shadows and lighting ask for, in sixteen bytes, since on a software
 * rasterizer each channel fetched costs as much as a page of arithmetic. GLSL's half is shaders/pixel.glsl.
 *
 * Octahedral normals: Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors". */
#pragma once

#include <math.h>
#include <stdint.h>

struct pixel {
    uint32_t geometric; /* unit geometric normal turned to the eye: octahedral, two snorm16 (within 0.002 degrees) */
    float depth;        /* along view.forward; 0: background */
    uint32_t shading;   /* unit shading normal, octahedral, 12 + 12 bits; metallic in the high 8 */
    uint32_t color;     /* square root of base colour, 8 bits a channel; roughness in the high 8 */
};

/* Folds v (any length but 0) onto the octahedron: both in [-1, 1]. */
static inline void octahedral_fold(float x, float y, float z, float *u, float *v)
{
    float scale = 1 / (fabsf(x) + fabsf(y) + fabsf(z));
    float a = x * scale, b = y * scale;
    float fa = (1 - fabsf(b)) * (a >= 0 ? 1.0f : -1.0f), fb = (1 - fabsf(a)) * (b >= 0 ? 1.0f : -1.0f);
    *u = z < 0 ? fa : a;
    *v = z < 0 ? fb : b;
}

static inline uint32_t pixel_pack_geometric(float x, float y, float z)
{
    float u, v;
    octahedral_fold(x, y, z, &u, &v);
    int a = (int)(u * 32767 + (u < 0 ? -0.5f : 0.5f)), b = (int)(v * 32767 + (v < 0 ? -0.5f : 0.5f));
    return ((uint32_t)a & 0xffff) | (uint32_t)b << 16;
}

/* metallic as its 8 bits. */
static inline uint32_t pixel_pack_shading(float x, float y, float z, uint32_t metallic)
{
    float u, v;
    octahedral_fold(x, y, z, &u, &v);
    return (uint32_t)((u + 1) * 2047.5f + 0.5f) | (uint32_t)((v + 1) * 2047.5f + 0.5f) << 12 | metallic << 24;
}

static inline uint32_t pixel_unorm8(float x) { return (uint32_t)((x < 0 ? 0 : x > 1 ? 1 : x) * 255 + 0.5f); }

static inline uint32_t pixel_pack_color(const float rgb[3], float roughness)
{
    return pixel_unorm8(sqrtf(rgb[0])) | pixel_unorm8(sqrtf(rgb[1])) << 8 | pixel_unorm8(sqrtf(rgb[2])) << 16 |
           pixel_unorm8(roughness) << 24;
}

/* For tests and CPU readers. */
static inline void pixel_geometric(const struct pixel *p, float out[3])
{
    float u = (float)(int16_t)(p->geometric & 0xffff) / 32767, v = (float)(int16_t)(p->geometric >> 16) / 32767;
    float z = 1 - fabsf(u) - fabsf(v), t = z < 0 ? -z : 0;
    out[0] = u + (u >= 0 ? -t : t);
    out[1] = v + (v >= 0 ? -t : t);
    out[2] = z;
    float length = sqrtf(out[0] * out[0] + out[1] * out[1] + z * z);
    for (int i = 0; i < 3; i++)
        out[i] /= length;
}
