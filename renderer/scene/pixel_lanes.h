/* Eight pixels of a row at once (scene/pixel.h, base/lanes.h). Included only by code that is compiled once an instruction set. */
#pragma once

#include "base/lanes.h"
#include "scene/pixel.h"
#include "scene/pixel_rays.h"

struct vector_lanes {
    lanes x, y, z;
};

struct pixel_lanes {
    lane_ints geometric, shading, color;
    lanes depth;
};

LANES_INLINE lanes lanes_dot(const struct vector_lanes *a, const struct vector_lanes *b)
{
    return a->x * b->x + a->y * b->y + a->z * b->z;
}

LANES_INLINE struct vector_lanes lanes_scaled(const struct vector_lanes *v, lanes s)
{
    return (struct vector_lanes){v->x * s, v->y * s, v->z * s};
}

LANES_INLINE struct vector_lanes lanes_unit(const struct vector_lanes *v)
{
    return lanes_scaled(v, 1 / lanes_sqrt(lanes_dot(v, v)));
}

LANES_INLINE struct pixel_lanes pixel_lanes_load(const struct pixel *p)
{
    struct pixel_lanes out;
#ifdef __AVX2__
    const __m256i *q = (const __m256i *)p;
    const __m256i order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
    __m256i a = _mm256_loadu_si256(q), b = _mm256_loadu_si256(q + 1), c = _mm256_loadu_si256(q + 2),
            d = _mm256_loadu_si256(q + 3);
    __m256i ab = _mm256_unpacklo_epi32(a, b), cd = _mm256_unpacklo_epi32(c, d);
    __m256i hab = _mm256_unpackhi_epi32(a, b), hcd = _mm256_unpackhi_epi32(c, d);
    out.geometric = (lane_ints)_mm256_permutevar8x32_epi32(_mm256_unpacklo_epi64(ab, cd), order);
    out.depth = (lanes)_mm256_permutevar8x32_epi32(_mm256_unpackhi_epi64(ab, cd), order);
    out.shading = (lane_ints)_mm256_permutevar8x32_epi32(_mm256_unpacklo_epi64(hab, hcd), order);
    out.color = (lane_ints)_mm256_permutevar8x32_epi32(_mm256_unpackhi_epi64(hab, hcd), order);
#else
    for (int i = 0; i < LANES; i++) {
        out.geometric[i] = (int32_t)p[i].geometric;
        out.depth[i] = p[i].depth;
        out.shading[i] = (int32_t)p[i].shading;
        out.color[i] = (int32_t)p[i].color;
    }
#endif
    return out;
}

/* octahedral_raw() of shaders/pixel.glsl: of the right direction, of any length in [0.57, 1]. */
LANES_INLINE struct vector_lanes octahedral_unfold(lanes u, lanes v)
{
    lanes w = 1 - lanes_abs(u) - lanes_abs(v), t = lanes_max(-w, lanes_all(0));
    return (struct vector_lanes){u + lanes_pick(u >= 0, -t, t), v + lanes_pick(v >= 0, -t, t), w};
}

/* Their geometric normals, likewise. */
LANES_INLINE struct vector_lanes pixel_lanes_geometric(lane_ints geometric)
{
    return octahedral_unfold(lanes_from((geometric << 16) >> 16) * (1.0f / 32767), lanes_from(geometric >> 16) * (1.0f / 32767));
}

LANES_INLINE lanes pixel_lanes_ray(const float at[3], const float dx[3], const float dy[3], int axis, lanes x, float y)
{
    return at[axis] + x * dx[axis] + y * dy[axis];
}

LANES_INLINE struct vector_lanes pixel_lanes_direction(const struct pixel_rays *r, lanes x, float y)
{
    return (struct vector_lanes){pixel_lanes_ray(r->direction, r->direction_dx, r->direction_dy, 0, x, y),
                                 pixel_lanes_ray(r->direction, r->direction_dx, r->direction_dy, 1, x, y),
                                 pixel_lanes_ray(r->direction, r->direction_dx, r->direction_dy, 2, x, y)};
}

LANES_INLINE struct vector_lanes pixel_lanes_origin(const struct pixel_rays *r, lanes x, float y)
{
    return (struct vector_lanes){pixel_lanes_ray(r->origin, r->origin_dx, r->origin_dy, 0, x, y),
                                 pixel_lanes_ray(r->origin, r->origin_dx, r->origin_dy, 1, x, y),
                                 pixel_lanes_ray(r->origin, r->origin_dx, r->origin_dy, 2, x, y)};
}
