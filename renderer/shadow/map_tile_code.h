/* How a tile is rasterized. Included by the kernels only (map_tile_plain.c, map_tile_avx2.c): the same arithmetic, so the same bits. */
#pragma once

#include "shadow/map_tile.h"

#include <math.h>
#include <string.h>

#include "shadow/map_facets.h"

#define INLINE static inline __attribute__((always_inline))

enum { TEXELS = MAP_TILE * MAP_TILE };

#define HOLE_AWAY 0.5f /* texels: covers the centre, with a hole there */
#define WILD_AWAY 1.0f /* texels: triangles whose distance nobody works out */

/* A row more than the tile has: two are worked on at a time. */
struct work {
    float nearest[TEXELS + MAP_TILE], rank[TEXELS + MAP_TILE];
    uint32_t id[TEXELS + MAP_TILE];
} __attribute__((aligned(64)));

/* One of eight, and where it goes. */
struct mark {
    const struct geometry_map *map;
    const struct map_facets *facets;
    int lane;
    uint32_t id;
    const struct light_part *holes; /* NULL: its material has none */
    float left, top;
    struct work *work;
};

/* Takes texels whose centre lies in a hole out of `covered`; lane i's is (x[i], y[i]). */
static void refuse_holes(const struct mark *k, const float *x, const float *y, int32_t *covered)
{
    struct light_hit hit;
    for (int i = 0; i < CONSERVATIVE_LANES; i++)
        if (covered[i] &&
            !light_triangle_solid_hit(&k->map->mesh, k->holes, k->id, k->left + x[i] + 0.5f, k->top + y[i] + 0.5f, &hit))
            covered[i] = 0;
}

/* Eight texels: where they are, which of them matter, what the work says of them. */
struct texels {
    lanes_float x, y;
    lanes_int among;
    lanes_float nearest, rank;
    lanes_uint id;
};

INLINE void mark_texels(const struct mark *k, struct texels *t)
{
    const struct map_facets *f = k->facets;
    int lane = k->lane;
    lanes_float edge[3], away = {};
    lanes_int touched = t->among, covered = ~(lanes_int){};
    for (int e = 0; e < 3; e++) {
        edge[e] = f->a[e][lane] * t->x + (f->b[e][lane] * t->y + f->c[e][lane]);
        touched &= edge[e] >= -f->reach[e][lane];
        covered &= edge[e] >= 0;
        lanes_float beyond = -edge[e] * f->inverse[e][lane];
        away = e == 0 ? beyond : LANES_MAX(away, beyond);
    }
    if (k->holes) {
        lanes_int before = covered & touched;
        covered = before;
        refuse_holes(k, (const float *)&t->x, (const float *)&t->y, (int32_t *)&covered);
        away = LANES_IF(before & ~covered, LANES_ALL(HOLE_AWAY * RANK_STEPS), away);
    }
    lanes_float n = f->nx[lane] * t->x + (f->ny[lane] * t->y + f->n[lane]);
    lanes_float near = n + f->slack[lane], most = LANES_ALL(f->most[lane]);
    away = __builtin_convertvector(__builtin_convertvector(away, lanes_int), lanes_float) + f->behind[lane];
    lanes_float rank = LANES_IF(covered, -n, away);
    near = LANES_MIN(near, most);
    t->nearest = LANES_IF(touched & (near > t->nearest), near, t->nearest);
    lanes_int better = touched & (rank < t->rank);
    t->rank = LANES_IF(better, rank, t->rank);
    t->id = (lanes_uint)LANES_IF(better, (lanes_float)((lanes_uint){} + k->id), (lanes_float)t->id);
}

/* Eight texels of row y from column x on, a multiple of eight. */
INLINE void mark_row(const struct mark *k, int32_t x, int32_t y)
{
    const struct map_facets *f = k->facets;
    lanes_float columns = LANES_COUNT + (float)x;
    size_t at = (size_t)y * MAP_TILE + (size_t)x;
    lanes_float *nearest = (lanes_float *)&k->work->nearest[at], *ranks = (lanes_float *)&k->work->rank[at];
    lanes_uint *ids = (lanes_uint *)&k->work->id[at];
    lanes_int among = (columns >= (float)f->x0[k->lane]) & (columns <= (float)f->x1[k->lane]);
    struct texels t = {columns, LANES_ALL((float)y), among, *nearest, *ranks, *ids};
    mark_texels(k, &t);
    *nearest = t.nearest;
    *ranks = t.rank;
    *ids = t.id;
}

typedef float quarter_loose __attribute__((vector_size(16), aligned(4), may_alias));

#define TWO_ROWS(array, at) LANES_OF(*(const quarter_loose *)&(array)[at], *(const quarter_loose *)&(array)[(at) + MAP_TILE])
#define PUT_TWO_ROWS(array, at, value)                                                                   \
    do {                                                                                                 \
        *(quarter_loose *)&(array)[at] = __builtin_shufflevector(value, value, 0, 1, 2, 3);              \
        *(quarter_loose *)&(array)[(at) + MAP_TILE] = __builtin_shufflevector(value, value, 4, 5, 6, 7); \
    } while (0)
#define TWO_ROWS_X ((lanes_float){0, 1, 2, 3, 0, 1, 2, 3})
#define TWO_ROWS_Y ((lanes_float){0, 0, 0, 0, 1, 1, 1, 1})

/* Where four columns begin that hold all of a narrow box. */
INLINE int32_t four_from(int32_t x0) { return x0 < (int32_t)MAP_TILE - 4 ? x0 : (int32_t)MAP_TILE - 4; }

/* A box at most four texels wide: four columns of two rows at a time. */
INLINE void mark_narrow(const struct mark *k)
{
    const struct map_facets *f = k->facets;
    struct work *w = k->work;
    int32_t first = four_from(f->x0[k->lane]), bottom = f->y1[k->lane];
    lanes_float x = TWO_ROWS_X + (float)first;
    lanes_int within = (x >= (float)f->x0[k->lane]) & (x <= (float)f->x1[k->lane]);
    for (int32_t row = f->y0[k->lane]; row <= bottom; row += 2) {
        size_t at = (size_t)row * MAP_TILE + (size_t)first;
        lanes_float y = TWO_ROWS_Y + (float)row;
        lanes_float ids = TWO_ROWS(w->id, at);
        struct texels t = {x, y, within & (y <= (float)bottom), TWO_ROWS(w->nearest, at), TWO_ROWS(w->rank, at), (lanes_uint)ids};
        mark_texels(k, &t);
        ids = (lanes_float)t.id;
        PUT_TWO_ROWS(w->nearest, at, t.nearest);
        PUT_TWO_ROWS(w->rank, at, t.rank);
        PUT_TWO_ROWS(w->id, at, ids);
    }
}

/* What of row y the edges leave, a little more than less: most of a long thin triangle's box is empty. */
struct spans {
    float at[3], step[3]; /* edge e crosses row y at at + step y */
    bool left[3], right[3];
};

INLINE struct spans find_spans(const struct map_facets *f, int lane)
{
    struct spans s;
    for (int e = 0; e < 3; e++) {
        float a = f->a[e][lane], inverse = 1 / a;
        s.at[e] = -(f->c[e][lane] + f->reach[e][lane]) * inverse;
        s.step[e] = -f->b[e][lane] * inverse;
        /* Steep enough that the crossing is sure to within a texel. */
        s.left[e] = a > 0 && fabsf(s.at[e]) < 1e5f && fabsf(s.step[e]) < 1e3f;
        s.right[e] = a < 0 && fabsf(s.at[e]) < 1e5f && fabsf(s.step[e]) < 1e3f;
    }
    return s;
}

INLINE void mark_wide(const struct mark *k)
{
    const struct map_facets *f = k->facets;
    int32_t x0 = f->x0[k->lane], x1 = f->x1[k->lane], y0 = f->y0[k->lane], y1 = f->y1[k->lane];
    int32_t first = x0 & ~(CONSERVATIVE_LANES - 1);
    if (x1 - first < CONSERVATIVE_LANES) {
        for (int32_t y = y0; y <= y1; y++)
            mark_row(k, first, y);
        return;
    }
    struct spans s = find_spans(f, k->lane);
    for (int32_t y = y0; y <= y1; y++) {
        float from = (float)x0, to = (float)x1;
        for (int e = 0; e < 3; e++) {
            float cross = s.at[e] + s.step[e] * (float)y;
            from = s.left[e] && cross - 1 > from ? cross - 1 : from;
            to = s.right[e] && cross + 1 < to ? cross + 1 : to;
        }
        if (!(from <= to))
            continue;
        for (int32_t x = (int32_t)from & ~(CONSERVATIVE_LANES - 1); x <= (int32_t)to; x += CONSERVATIVE_LANES)
            mark_row(k, x, y);
    }
}

/* Whether everything in the triangle's box is known to be nearer than its nearest corner: it would change nothing. Half of a closed mesh. */
INLINE bool is_hidden(const struct map_facets *f, int lane, const struct work *w)
{
    int32_t x0 = f->x0[lane], x1 = f->x1[lane], row = f->y0[lane], bottom = f->y1[lane];
    lanes_float most = LANES_ALL(-f->most[lane]), columns;
    lanes_int open = {};
    if (x1 - x0 < 4) {
        int32_t first = four_from(x0);
        columns = TWO_ROWS_X + (float)first;
        for (; row < bottom; row += 2)
            open |= TWO_ROWS(w->rank, row * (int32_t)MAP_TILE + first) > most;
        if (row == bottom) {
            lanes_quarter last = *(const quarter_loose *)&w->rank[row * (int32_t)MAP_TILE + first];
            open |= LANES_OF(last, last) > most;
        }
    } else {
        int32_t first = x0 & ~(CONSERVATIVE_LANES - 1);
        if (x1 - first >= CONSERVATIVE_LANES)
            return false; /* not worth the look */
        columns = LANES_COUNT + (float)first;
        for (; row <= bottom; row++)
            open |= *(const lanes_float *)&w->rank[row * (int32_t)MAP_TILE + first] > most;
    }
    open &= (columns >= (float)x0) & (columns <= (float)x1);
    return !LANES_ANY(open);
}

/* Up to eight triangles of a tile; lanes beyond `count` repeat the first. */
struct batch {
    uint32_t id[CONSERVATIVE_LANES];
    const struct light_part *part[CONSERVATIVE_LANES];
    struct light_triangle triangle[CONSERVATIVE_LANES];
    int count;
};

/* Numbers [first, first + 8) of the tile's, as far as there are. */
static void take_batch(const struct geometry_map *m, const uint32_t *triangles, size_t first, size_t end, uint32_t *hint,
                       struct batch *b)
{
    b->count = end - first < CONSERVATIVE_LANES ? (int)(end - first) : CONSERVATIVE_LANES;
    for (int i = 0; i < CONSERVATIVE_LANES; i++) {
        size_t at = first + (size_t)(i < b->count ? i : 0);
        const struct light_part *part = light_mesh_part(&m->mesh, triangles[at], hint);
        if (at + LIGHT_INDICES_AHEAD < end)
            light_part_prefetch_indices(part, triangles[at + LIGHT_INDICES_AHEAD]);
        if (at + LIGHT_VERTICES_AHEAD < end)
            light_part_prefetch_vertices(part, triangles[at + LIGHT_VERTICES_AHEAD]);
        b->id[i] = triangles[at];
        b->part[i] = part;
        b->triangle[i] = light_part_triangle(part, triangles[at]);
    }
}

INLINE void mark_triangles(const struct geometry_map *m, const uint32_t *triangles, size_t count, float left, float top,
                           struct work *w)
{
    uint32_t hint = 0;
    for (size_t first = 0; first < count; first += CONSERVATIVE_LANES) {
        struct batch batch;
        struct map_facets f;
        take_batch(m, triangles, first, count, &hint, &batch);
        map_facets_box(&f, batch.triangle, left, top, MAP_TILE);
        unsigned open = 0;
        for (int i = 0; i < batch.count; i++)
            open |= f.over[i] && !is_hidden(&f, i, w) ? 1u << i : 0;
        if (!open)
            continue;
        map_facets_set(&f, m->mesh.nearest, MAP_TILE);
        for (; open; open &= open - 1) {
            int i = __builtin_ctz(open);
            struct mark mark = {m, &f, i, batch.id[i], NULL, left, top, w};
            /* Thin in projection: may have no area at all, and casts nothing then. */
            if (f.thin[i] && light_part_degenerate(m->mesh.scene, batch.part[i], batch.id[i]))
                continue;
            if (batch.part[i]->holes) {
                mark.holes = batch.part[i];
                mark_wide(&mark);
            } else if (f.x1[i] - f.x0[i] < 4) {
                mark_narrow(&mark);
            } else {
                mark_wide(&mark);
            }
        }
    }
}

/* A wild triangle's edges and nearness as functions of the map position, in double. Outside where an edge is negative. */
struct wild_facet {
    double edge[3][3]; /* e = [0] x + [1] y + [2] */
    double n[3];       /* likewise; unless flat */
    double most;
    bool flat; /* seen edge-on: as near as `most` everywhere */
};

static void to_map(const struct light_mesh *m, struct dvec3 v, double out[3])
{
    out[0] = v.x / m->scale_x;
    out[1] = v.y / m->scale_y;
    out[2] = v.z - out[0] * m->offset_x - out[1] * m->offset_y;
}

/* Perspective only: an orthographic map holds all of its casters. */
static void set_wild(struct wild_facet *f, const struct light_mesh *m, const struct dvec3 c[3])
{
    struct dvec3 normal = dvec3_cross(dvec3_sub(c[1], c[0]), dvec3_sub(c[2], c[0]));
    double volume = dvec3_dot(normal, c[0]), sign = volume < 0 ? -1 : 1;
    f->most = 0;
    for (int k = 0; k < 3; k++) {
        to_map(m, dvec3_scale(dvec3_cross(c[(k + 1) % 3], c[(k + 2) % 3]), sign), f->edge[k]);
        f->most = fmax(f->most, c[k].z > 0 ? 1 / c[k].z : INFINITY);
    }
    f->flat = !(fabs(volume) > 1e-12 * dvec3_length(normal) * dvec3_length(c[0]));
    if (!f->flat)
        to_map(m, dvec3_scale(normal, 1 / volume), f->n);
}

/* Over a square of `side` texels about (x, y) and the margin. */
static double highest_over(const double e[3], double x, double y, double side)
{
    double half = side / 2 + (double)CONSERVATIVE_MARGIN;
    return e[0] * x + e[1] * y + e[2] + half * (fabs(e[0]) + fabs(e[1]));
}

static double highest(const double e[3], double x, double y) { return highest_over(e, x, y, 1); }

static void mark_wild_texel(const struct geometry_map *m, const struct light_part *part, const struct wild_facet *f, uint32_t id,
                            double x, double y, struct work *w, size_t at)
{
    for (int k = 0; k < 3; k++)
        if (highest(f->edge[k], x, y) < 0)
            return;
    struct light_hit hit;
    bool covered = light_triangle_solid_hit(&m->mesh, part, id, (float)x, (float)y, &hit);
    float rank = covered ? -hit.n : WILD_AWAY * RANK_STEPS + 0.5f;
    float near = f->flat ? (float)f->most : (float)(fmin(highest(f->n, x, y), f->most) * (1 + 0x1p-20));
    w->nearest[at] = fmaxf(w->nearest[at], near);
    if (rank < w->rank[at]) {
        w->rank[at] = rank;
        w->id[at] = id;
    }
}

static void mark_wild(const struct geometry_map *m, uint32_t id, float left, float top, struct work *w)
{
    uint32_t hint = 0;
    const struct light_part *part = light_mesh_part(&m->mesh, id, &hint);
    struct dvec3 c[3];
    for (unsigned k = 0; k < 3; k++)
        c[k] = light_part_corner(&m->mesh, part, id, k);
    if (light_corners_miss(&m->mesh, c, left, top, left + MAP_TILE, top + MAP_TILE))
        return;
    struct wild_facet f;
    set_wild(&f, &m->mesh, c);
    for (int k = 0; k < 3; k++)
        if (highest_over(f.edge[k], left + MAP_TILE / 2.0, top + MAP_TILE / 2.0, MAP_TILE) < 0)
            return;
    for (uint32_t i = 0; i < TEXELS; i++)
        mark_wild_texel(m, part, &f, id, left + i % MAP_TILE + 0.5, top + i / MAP_TILE + 0.5, w, i);
}

static void rasterize(const struct geometry_map *m, uint32_t tile_x, uint32_t tile_y, const uint32_t *triangles, size_t count,
                      struct map_cell *cells)
{
    struct work w;
    float left = (float)(tile_x * MAP_TILE), top = (float)(tile_y * MAP_TILE);
    for (size_t i = 0; i < sizeof w.id / sizeof *w.id; i++) {
        w.nearest[i] = -INFINITY;
        w.rank[i] = INFINITY;
        w.id[i] = MAP_NONE;
    }
    mark_triangles(m, triangles, count, left, top, &w);
    for (size_t i = 0; i < m->wild_count; i++)
        mark_wild(m, m->wild[i], left, top, &w);
    for (int i = 0; i < TEXELS; i++)
        cells[i] = (struct map_cell){w.nearest[i], w.rank[i] >= 0 ? w.id[i] | MAP_OFF_EDGE : w.id[i]};
}
