/* Eight pixels' receivers, and where they lie on the light's maps. Included by kernels only (depth_plain.c, depth_avx2.c and
 * the like). */
#pragma once

#include <string.h>

#include "scene/pixel_lanes.h"
#include "shadow/depth/depth_pass.h"

/* The dot product with the first three of `row`. */
LANES_INLINE lanes lanes_along(const float row[3], const struct vector_lanes *v)
{
    return row[0] * v->x + row[1] * v->y + row[2] * v->z;
}

/* struct Receiver of shaders/receiver.glsl. */
struct receivers {
    struct vector_lanes point, direction; /* of the pixel's ray */
    struct vector_lanes normal;           /* not of unit length */
    struct vector_lanes v;                /* to the light, or against a directional one's direction */
    lanes depth, d2, n_v;                 /* along the camera's axis; v . v; normal . v */
    lanes n2;                             /* normal . normal */
    lane_ints receives;
};

/* Of eight pixels of row y, fx their columns. False: none of them receives light, and only `receives` is set. */
LANES_INLINE bool receivers_of(const struct depth_job *job, const struct pixel *pixels, lanes fx, uint32_t y, struct receivers *r)
{
    struct pixel_lanes p = pixel_lanes_load(pixels);
    r->depth = p.depth;
    r->receives = r->depth > 0;
    if (!lanes_bits(r->receives))
        return false;
    const float *light = job->light.light;
    struct vector_lanes origin = pixel_lanes_origin(&job->rays, fx, (float)y);
    r->direction = pixel_lanes_direction(&job->rays, fx, (float)y);
    r->point.x = origin.x + r->depth * r->direction.x;
    r->point.y = origin.y + r->depth * r->direction.y;
    r->point.z = origin.z + r->depth * r->direction.z;
    r->v = (struct vector_lanes){lanes_all(light[0]), lanes_all(light[1]), lanes_all(light[2])};
    if (job->light.kind != LIGHT_DIRECTIONAL) {
        r->v.x -= r->point.x;
        r->v.y -= r->point.y;
        r->v.z -= r->point.z;
    }
    r->normal = pixel_lanes_geometric(p.geometric);
    r->d2 = lanes_dot(&r->v, &r->v);
    r->n_v = lanes_dot(&r->normal, &r->v);
    r->n2 = lanes_dot(&r->normal, &r->normal);
    r->receives &= (r->n_v > 0) & (r->d2 <= job->light.range2);
    if (job->light.kind == LIGHT_SPOT)
        r->receives &= -lanes_along(job->light.axis, &r->v) >= job->light.cosine * lanes_sqrt(r->d2);
    return lanes_bits(r->receives) != 0;
}

/* Of neighbours, the first at (x, y). */
LANES_INLINE bool receivers_at(const struct depth_job *job, const struct pixel *pixels, uint32_t x, uint32_t y,
                               struct receivers *r)
{
    return receivers_of(job, pixels, (float)x + (lanes){0, 1, 2, 3, 4, 5, 6, 7}, y, r);
}

LANES_INLINE lanes tangent_of(const struct receivers *r)
{
    return lanes_sqrt(lanes_max(r->n2 * r->d2 / (r->n_v * r->n_v) - 1, lanes_all(0)));
}

/* struct MapPoint of shaders/maps.glsl. */
struct map_points {
    lane_ints on;      /* some map holds the point */
    lane_ints map;     /* which; 0 where none does */
    lanes x, y;        /* texels; 0 where none does */
    lanes depth;       /* along the map's axis */
    lanes texel;       /* world size of one there */
    lanes near, range; /* of the map, and far - near */
    lanes far;
};

LANES_INLINE void place_on(const struct depth_job *job, unsigned i, const struct vector_lanes *point, lane_ints open,
                           struct map_points *m)
{
    const struct depth_map *map = &job->maps[i];
    lanes qx = lanes_along(map->row[0], point) + map->row[0][3], qy = lanes_along(map->row[1], point) + map->row[1][3];
    lanes depth = lanes_along(map->row[2], point) + map->row[2][3], texel = lanes_all(map->texel);
    lane_ints before = lane_ints_all(-1);
    if (!job->orthographic) {
        lanes inverse = 1 / depth;
        qx *= inverse;
        qy *= inverse;
        texel *= depth;
        before = depth > 0;
    }
    lanes x = qx * map->scale_x + map->offset_x, y = qy * map->scale_y + map->offset_y, side = lanes_all((float)job->side);
    lane_ints in = before & open & (x >= 0) & (y >= 0) & (x < side) & (y < side);
    m->on |= in;
    m->map |= in & lane_ints_all((int32_t)i);
    m->x = lanes_pick(in, x, m->x);
    m->y = lanes_pick(in, y, m->y);
    m->depth = lanes_pick(in, depth, m->depth);
    m->texel = lanes_pick(in, texel, m->texel);
    m->near = lanes_pick(in, lanes_all(map->near), m->near);
    m->range = lanes_pick(in, lanes_all(map->range), m->range);
    m->far = lanes_pick(in, lanes_all(map->far), m->far);
}

/* The first map whose picture holds a receiver answers for it. */
LANES_INLINE void place_receivers(const struct depth_job *job, const struct receivers *r, struct map_points *m)
{
    m->on = m->map = lane_ints_all(0);
    m->x = m->y = m->texel = m->near = m->range = m->far = lanes_all(0);
    m->depth = lanes_all(1);
    for (unsigned i = 0; i < job->map_count; i++) {
        lane_ints open = r->receives & ~m->on;
        if (!lanes_bits(open))
            break;
        place_on(job, i, &r->point, open, m);
    }
}

/* The depth that is compared: less the bias, constant + slope x texel x tangent of the angle of incidence. */
LANES_INLINE lanes biased_depth(const struct depth_job *job, const struct receivers *r, const struct map_points *m)
{
    return m->depth - (job->bias + job->slope * m->texel * tangent_of(r));
}

/* Index of texel (x, y) of each lane's map. */
LANES_INLINE lane_ints texel_at(const struct depth_job *job, const struct map_points *m, lane_ints x, lane_ints y)
{
    return (m->map * job->side + y) * job->side + x;
}

/* Whether something lies before a point at `depth`: map_lit() of shaders/maps.glsl, the other way round. */
LANES_INLINE lane_ints texel_blocks(const struct depth_job *job, lanes stored, lanes depth, lanes near, lanes range, lanes far)
{
    return job->orthographic ? (stored != 0) & (depth > far - stored * range) : stored * depth > near;
}

LANES_INLINE uint32_t lesser(uint32_t a, uint32_t b) { return a < b ? a : b; }

/* Eight pixels at (x, y), of which the picture may hold only some; those beyond have no surface. */
LANES_INLINE const struct pixel *pixels_at(const struct depth_job *job, uint32_t x, uint32_t y, struct pixel room[LANES])
{
    const struct pixel *pixels = job->pixels + (size_t)y * job->width + x;
    uint32_t count = job->width - x;
    /* The next row's, or past the end: no harm. */
    __builtin_prefetch(pixels + job->width);
    __builtin_prefetch(pixels + job->width + LANES / 2);
    if (count >= LANES)
        return pixels;
    memset(room, 0, LANES * sizeof *room);
    memcpy(room, pixels, count * sizeof *room);
    return room;
}

LANES_INLINE void put_values(float *out, lanes values, uint32_t count)
{
    if (count >= LANES)
        lanes_store(out, values);
    else
        for (uint32_t i = 0; i < count; i++)
            out[i] = values[i];
}
