/* What shaders/lighting.frag, brdf.glsl and tonemap.glsl do, eight pixels at a time: changes there are to be made here too (tests/gpu/test_lighting.c
 * holds one against the other). Included by lighting_plain.c and lighting_avx2.c. */
#pragma once

#include <math.h>
#include <string.h>

#include "passes/lighting_pixels.h"
#include "scene/pixel_lanes.h"

struct lit_lanes {
    struct vector_lanes base, normal, to_eye, point;
    lanes metallic, roughness;
};

/* Byte `shift` / 8 of each, in [0, 1]. */
LANES_INLINE lanes unorm8(lane_ints packed, int shift) { return lanes_from((packed >> shift) & 255) * (1.0f / 255); }

LANES_INLINE lanes squared(lanes x) { return x * x; }

LANES_INLINE lanes clamped(lanes x) { return lanes_min(lanes_max(x, lanes_all(0)), lanes_all(1)); }

LANES_INLINE struct lit_lanes lit_at(const struct pixel_rays *rays, const struct pixel_lanes *p, uint32_t x, uint32_t y)
{
    lanes fx = (float)x + (lanes){0, 1, 2, 3, 4, 5, 6, 7};
    struct vector_lanes origin = pixel_lanes_origin(rays, fx, (float)y), d = pixel_lanes_direction(rays, fx, (float)y);
    struct vector_lanes n = octahedral_unfold(lanes_from(p->shading & 4095) * (1 / 2047.5f) - 1,
                                              lanes_from((p->shading >> 12) & 4095) * (1 / 2047.5f) - 1);
    struct vector_lanes back = {-d.x, -d.y, -d.z};
    return (struct lit_lanes){
        .base = {squared(unorm8(p->color, 0)), squared(unorm8(p->color, 8)), squared(unorm8(p->color, 16))},
        .normal = lanes_unit(&n),
        .to_eye = lanes_unit(&back),
        .point = {origin.x + p->depth * d.x, origin.y + p->depth * d.y, origin.z + p->depth * d.z},
        .metallic = unorm8(p->shading, 24),
        .roughness = unorm8(p->color, 24),
    };
}

/* arriving(): the light's irradiance over its colour; the way to it to `l`. */
LANES_INLINE lanes arriving(const struct lights_block *b, size_t i, const struct vector_lanes *point, struct vector_lanes *l)
{
    const float *position = b->lights_position[i], *direction = b->lights_direction[i];
    if (position[3] == LIGHT_KIND_DIRECTIONAL) {
        *l = (struct vector_lanes){lanes_all(-direction[0]), lanes_all(-direction[1]), lanes_all(-direction[2])};
        return lanes_all(1);
    }
    struct vector_lanes v = {position[0] - point->x, position[1] - point->y, position[2] - point->z};
    lanes d2 = lanes_max(lanes_dot(&v, &v), lanes_all(1e-30f)), fall = 1 / d2;
    *l = lanes_scaled(&v, lanes_sqrt(fall));
    lanes q = direction[3] * d2;
    fall *= clamped(1 - q * q);
    if (position[3] == LIGHT_KIND_SPOT) {
        lanes along = l->x * direction[0] + l->y * direction[1] + l->z * direction[2];
        fall *= squared(clamped(b->lights_cone[i][1] - along * b->lights_cone[i][0]));
    }
    return fall;
}

/* One channel of brdf_times_cosine(). */
LANES_INLINE lanes reflected(lanes base, lanes metallic, lanes specular, lanes fifth)
{
    lanes f0 = 0.04f + (base - 0.04f) * metallic, fresnel = f0 + (1 - f0) * fifth;
    lanes diffuse = base * ((1 - metallic) * (float)(1 / M_PI));
    return diffuse + (specular - diffuse) * fresnel;
}

LANES_INLINE void add_light(const struct lit_lanes *s, const struct vector_lanes *l, lanes arrives, const float color[3],
                            struct vector_lanes *sum)
{
    lanes n_l = lanes_max(lanes_dot(&s->normal, l), lanes_all(0)), n_to_eye = lanes_dot(&s->normal, &s->to_eye);
    lanes n_e = lanes_max(lanes_abs(n_to_eye), lanes_all(1e-4f));
    lanes h2 = lanes_max(2 + 2 * lanes_dot(l, &s->to_eye), lanes_all(1e-6f)), n_h2 = squared(n_l + n_to_eye) / h2;
    lanes alpha = lanes_max(squared(s->roughness), lanes_all(1e-3f)), a2 = alpha * alpha, f = n_h2 * (a2 - 1) + 1;
    lanes smith = n_l * lanes_sqrt(n_e * n_e * (1 - a2) + a2) + n_e * lanes_sqrt(n_l * n_l * (1 - a2) + a2);
    lanes specular = a2 / ((float)(2 * M_PI) * f * f * smith + 1e-7f);
    lanes m = lanes_max(1 - 0.5f * lanes_sqrt(h2), lanes_all(0)), fifth = squared(squared(m)) * m;
    arrives *= n_l;
    sum->x += reflected(s->base.x, s->metallic, specular, fifth) * (arrives * color[0]);
    sum->y += reflected(s->base.y, s->metallic, specular, fifth) * (arrives * color[1]);
    sum->z += reflected(s->base.z, s->metallic, specular, fifth) * (arrives * color[2]);
}

/* x^(5/12) of x in [0.003, 1] within 3e-5 of it: x^(1/4) by roots, x^(1/6) as the cube root of the other, by one step of Halley's method from a third of
 * the exponent (Kahan's first guess). */
LANES_INLINE lanes power_5_12(lanes x)
{
    lanes root = lanes_sqrt(x);
    lanes guess = (lanes)(lanes_truncate(lanes_from((lane_ints)root) * (1.0f / 3)) + 709958130);
    lanes cube = guess * guess * guess;
    return lanes_sqrt(root) * (guess * (cube + 2 * root) / (2 * cube + root));
}

/* display_color(), as eight bits. */
LANES_INLINE lane_ints displayed(lanes c, bool aces)
{
    if (aces)
        c = c * (2.51f * c + 0.03f) / (c * (2.43f * c + 0.59f) + 0.14f);
    c = clamped(c);
    lanes curve = 1.055f * power_5_12(lanes_max(c, lanes_all(0.003f))) - 0.055f;
    return lanes_truncate(lanes_pick(c <= 0.0031308f, 12.92f * c, curve) * 255 + 0.5f);
}

LANES_INLINE lane_ints shade(const struct lighting_pixels *job, const struct pixel_lanes *p, const float *const *visibility,
                             uint32_t x, uint32_t y, uint32_t background)
{
    const struct lights_block *b = job->lights;
    struct lit_lanes s = lit_at(&job->rays, p, x, y);
    float ambient = b->picture[1], exposure = b->picture[0];
    struct vector_lanes sum = lanes_scaled(&s.base, lanes_all(ambient)), l;
    for (size_t i = 0; i < job->light_count; i++) {
        lanes arrives = arriving(b, i, &s.point, &l) * lanes_load(visibility[i]);
        add_light(&s, &l, arrives, b->lights_color[i], &sum);
    }
    lane_ints color = displayed(sum.x * exposure, job->aces) | displayed(sum.y * exposure, job->aces) << 8 |
                      displayed(sum.z * exposure, job->aces) << 16 | lane_ints_all((int32_t)0xff000000);
    return lane_ints_pick(p->depth > 0, color, lane_ints_all((int32_t)background));
}

LANES_INLINE void shade_eight(const struct lighting_pixels *job, const struct pixel *pixels, const float *const *visibility,
                              uint32_t x, uint32_t y, uint32_t background, uint32_t *out)
{
    struct pixel_lanes p = pixel_lanes_load(pixels);
    if (lanes_bits(p.depth > 0))
        lane_ints_store(out, shade(job, &p, visibility, x, y, background));
    else
        lane_ints_store(out, lane_ints_all((int32_t)background));
}

/* The last pixels of a row, fewer than eight. */
static void shade_tail(const struct lighting_pixels *job, uint32_t x, uint32_t y, uint32_t background)
{
    struct pixel pixels[LANES] = {0};
    float values[LIGHTS_MAX][LANES] = {{0}};
    const float *visibility[LIGHTS_MAX];
    uint32_t out[LANES];
    size_t at = (size_t)y * job->width + x, count = job->width - x;
    memcpy(pixels, job->pixels + at, count * sizeof *pixels);
    for (size_t i = 0; i < job->light_count; i++) {
        memcpy(values[i], job->visibility[i] + at, count * sizeof *values[i]);
        visibility[i] = values[i];
    }
    shade_eight(job, pixels, visibility, x, y, background, out);
    memcpy(job->picture + at, out, count * sizeof *out);
}

static void light_row(const struct lighting_pixels *job, uint32_t y, uint32_t background)
{
    const float *visibility[LIGHTS_MAX];
    uint32_t x = 0;
    for (; x + LANES <= job->width; x += LANES) {
        size_t at = (size_t)y * job->width + x;
        for (size_t i = 0; i < job->light_count; i++)
            visibility[i] = job->visibility[i] + at;
        shade_eight(job, job->pixels + at, visibility, x, y, background, job->picture + at);
    }
    if (x < job->width)
        shade_tail(job, x, y, background);
}
