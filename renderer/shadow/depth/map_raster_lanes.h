/* A band of a depth map, rasterized. Included by the kernels only (depth_plain.c, depth_avx*.c).
 *
 * Edges are inclusive, and the edge that two triangles share is computed from the same end in both: where one triangle finds a negative value the
 * other finds exactly its opposite, so that no texel centre falls between them. */
#pragma once

#include <string.h>

#include "base/lanes.h"
#include "shadow/depth/map_raster.h"

/* One of eight. */
struct raster_triangle {
    float a[3], b[3], c[3]; /* of edge k at the centre of texel (x, y): a x + b y + c, negative outside */
    float x, y, n, nx, ny;  /* what is stored at (x, y), and its change a texel along both axes */
    float least, most;
    int32_t x0, x1, y0, y1; /* texels whose centres its box holds, within the map and the band; inclusive */
};

/* The same of all eight. */
struct raster_batch {
    lanes a[3], b[3], c[3];
    lanes x, y, n, nx, ny, least, most;
    lane_ints x0, x1, y0, y1;
    lane_ints open; /* has an area and texels */
};

/* Corner k's x, y and n. */
typedef lanes raster_corners[3][3];

LANES_INLINE void take_corners(const struct raster_job *job, const uint32_t *entries, uint32_t count, raster_corners v)
{
    for (uint32_t i = 0; i < LANES; i++)
        for (int k = 0; k < 3; k++) {
            const struct light_vertex *corner = &job->raster->mesh.vertices[entries[3 * (i < count ? i : 0) + (unsigned)k]];
            v[k][0][i] = corner->x;
            v[k][1][i] = corner->y;
            v[k][2][i] = corner->n;
        }
}

LANES_INLINE void set_edge(struct raster_batch *t, int k, lanes *const from, lanes *const to, lane_ints mirrored)
{
    lane_ints ordered = (from[0] < to[0]) | ((from[0] == to[0]) & (from[1] < to[1]));
    lanes px = lanes_pick(ordered, from[0], to[0]), py = lanes_pick(ordered, from[1], to[1]);
    lanes qx = lanes_pick(ordered, to[0], from[0]), qy = lanes_pick(ordered, to[1], from[1]);
    lanes a = py - qy, b = qx - px, c = a * (0.5f - px) + b * (0.5f - py);
    lane_ints sign = (ordered ^ mirrored) & INT32_MIN; /* either turns it round */
    t->a[k] = -(lanes)((lane_ints)a ^ sign);
    t->b[k] = -(lanes)((lane_ints)b ^ sign);
    t->c[k] = -(lanes)((lane_ints)c ^ sign);
}

LANES_INLINE lanes least_lanes(lanes a, lanes b, lanes c) { return lanes_min(lanes_min(a, b), c); }
LANES_INLINE lanes most_lanes(lanes a, lanes b, lanes c) { return lanes_max(lanes_max(a, b), c); }

/* Of at most `last`: the texels whose centres lie in [low, high]. */
LANES_INLINE void centers(lanes low, lanes high, int32_t first, int32_t last, lane_ints *from, lane_ints *to)
{
    *from = lane_ints_max(lanes_truncate(lanes_max(low + 0.5f, lanes_all(0))), lane_ints_all(first));
    *to = lane_ints_min(lanes_truncate(lanes_max(high + 0.5f, lanes_all(0))) - 1, lane_ints_all(last));
}

LANES_INLINE void raster_setup(const struct raster_job *job, const raster_corners v, int32_t top, int32_t bottom,
                               struct raster_batch *t)
{
    lanes bx = v[1][0] - v[0][0], by = v[1][1] - v[0][1], bn = v[1][2] - v[0][2];
    lanes cx = v[2][0] - v[0][0], cy = v[2][1] - v[0][1], cn = v[2][2] - v[0][2];
    lanes area = bx * cy - cx * by, inverse = job->scale / area;
    for (int k = 0; k < 3; k++)
        set_edge(t, k, (lanes *)v[k], (lanes *)v[k == 2 ? 0 : k + 1], area < 0);
    t->x = v[0][0];
    t->y = v[0][1];
    t->n = v[0][2] * job->scale;
    t->nx = (bn * cy - cn * by) * inverse;
    t->ny = (bx * cn - cx * bn) * inverse;
    t->least = lanes_max(least_lanes(v[0][2], v[1][2], v[2][2]) * job->scale, lanes_all(0));
    t->most = lanes_min(most_lanes(v[0][2], v[1][2], v[2][2]) * job->scale, lanes_all(1));
    centers(least_lanes(v[0][0], v[1][0], v[2][0]), most_lanes(v[0][0], v[1][0], v[2][0]), 0, (int32_t)job->side - 1, &t->x0,
            &t->x1);
    centers(least_lanes(v[0][1], v[1][1], v[2][1]), most_lanes(v[0][1], v[1][1], v[2][1]), top, bottom, &t->y0, &t->y1);
    t->open = (area != 0) & (t->x0 <= t->x1) & (t->y0 <= t->y1);
}

LANES_INLINE struct raster_triangle one_of(const struct raster_batch *b, int i)
{
    struct raster_triangle t = {.x = b->x[i],
                                .y = b->y[i],
                                .n = b->n[i],
                                .nx = b->nx[i],
                                .ny = b->ny[i],
                                .least = b->least[i],
                                .most = b->most[i],
                                .x0 = b->x0[i],
                                .x1 = b->x1[i],
                                .y0 = b->y0[i],
                                .y1 = b->y1[i]};
    for (int k = 0; k < 3; k++) {
        t.a[k] = b->a[k][i];
        t.b[k] = b->b[k][i];
        t.c[k] = b->c[k][i];
    }
    return t;
}

/* Texel (x0 + dx, y0 + dy) of each of the eight: dense meshes are of triangles with no more than four. */
LANES_INLINE void raster_tiny(const struct raster_job *job, const struct raster_batch *t, lane_ints tiny, int dx, int dy)
{
    lane_ints column = t->x0 + dx, line = t->y0 + dy;
    lanes x = lanes_from(column), y = lanes_from(line);
    lane_ints in = tiny & (column <= t->x1) & (line <= t->y1);
    for (int k = 0; k < 3; k++)
        in &= t->a[k] * x + (t->b[k] * y + t->c[k]) >= 0;
    unsigned bits = lanes_bits(in);
    if (!bits)
        return;
    lanes near = t->n + t->ny * (y + (0.5f - t->y)) + t->nx * (x + (0.5f - t->x));
    near = lanes_min(lanes_max(near, t->least), t->most);
    lane_ints at = line * (int32_t)job->side + column;
    for (; bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        float *texel = &job->texels[at[i]];
        *texel = near[i] > *texel ? near[i] : *texel;
    }
}

/* Eight texels of row y from column x on. */
LANES_INLINE void raster_texels(const struct raster_triangle *t, float *texels, int32_t x, const float row[3], float n)
{
    lanes columns = (float)x + (lanes){0, 1, 2, 3, 4, 5, 6, 7}, stored = lanes_load(texels + x);
    lane_ints in = (columns >= (float)t->x0) & (columns <= (float)t->x1);
    for (int k = 0; k < 3; k++)
        in &= t->a[k] * columns + row[k] >= 0;
    lanes near = n + t->nx * (columns + (0.5f - t->x));
    near = lanes_min(lanes_max(near, lanes_all(t->least)), lanes_all(t->most));
    lanes_store(texels + x, lanes_max(lanes_if(in, near), stored));
}

/* What of [*x0, *x1] the edges leave in a row, a little more than less: most of a long thin triangle's box is empty. */
LANES_INLINE void narrow(const struct raster_triangle *t, const float row[3], int32_t *x0, int32_t *x1)
{
    float from = (float)*x0, to = (float)*x1;
    for (int k = 0; k < 3; k++) {
        float a = t->a[k], cross = -row[k] / a;
        if (a > 0 && cross - 1 > from)
            from = cross - 1;
        else if (a < 0 && cross + 1 < to)
            to = cross + 1;
    }
    if (from > to) {
        *x1 = *x0 - 1;
        return;
    }
    *x0 = (int32_t)from;
    *x1 = (int32_t)to;
}

LANES_INLINE void raster_triangle(const struct raster_job *job, const struct raster_triangle *t)
{
    int32_t last = (int32_t)job->side - LANES;
    bool wide = t->x1 - t->x0 >= 2 * LANES;
    for (int32_t y = t->y0; y <= t->y1; y++) {
        float row[3], n = t->n + t->ny * ((float)y + (0.5f - t->y));
        for (int k = 0; k < 3; k++)
            row[k] = t->b[k] * (float)y + t->c[k];
        int32_t x0 = t->x0, x1 = t->x1;
        if (wide)
            narrow(t, row, &x0, &x1);
        /* Never into the next row, which may be another thread's. */
        for (int32_t x = x0; x <= x1; x += LANES)
            raster_texels(t, job->texels + (size_t)y * job->side, x < last ? x : last, row, n);
    }
}

LANES_INLINE void raster_eight(const struct raster_job *job, const uint32_t *entries, uint32_t count, int32_t top, int32_t bottom)
{
    raster_corners corners;
    struct raster_batch t;
    take_corners(job, entries, count, corners);
    raster_setup(job, corners, top, bottom, &t);
    lane_ints tiny = t.open & (t.x1 - t.x0 <= 1) & (t.y1 - t.y0 <= 1);
    if (lanes_bits(tiny))
        for (int i = 0; i < 4; i++)
            raster_tiny(job, &t, tiny, i % 2, i / 2);
    for (unsigned bits = lanes_bits(t.open & ~tiny) & ((1u << count) - 1); bits; bits &= bits - 1) {
        struct raster_triangle one = one_of(&t, __builtin_ctz(bits));
        raster_triangle(job, &one);
    }
}

static void raster_band(void *context, size_t band, unsigned worker)
{
    (void)worker;
    const struct raster_job *job = context;
    const struct map_raster *r = job->raster;
    int32_t top = (int32_t)band * RASTER_ROWS, bottom = top + RASTER_ROWS - 1;
    bottom = bottom < (int32_t)job->side ? bottom : (int32_t)job->side - 1;
    memset(job->texels + (size_t)top * job->side, 0, (size_t)(bottom - top + 1) * job->side * sizeof *job->texels);
    if (r->chunks == 0)
        return;
    /* The counts have run on to where the next chunk's begin: a band's last is its end. */
    const uint32_t *ends = r->counts + (size_t)(r->chunks - 1) * r->bands;
    for (uint32_t i = band ? ends[band - 1] : 0, end = ends[band]; i < end; i += LANES)
        raster_eight(job, r->entries + 3 * (size_t)i, end - i < LANES ? end - i : LANES, top, bottom);
}
