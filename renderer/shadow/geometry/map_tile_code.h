/* How a tile is rasterized. Included by the kernels only (map_tile_plain.c, map_tile_avx2.c, map_tile_avx512.c): the same arithmetic, so the same bits. */
#pragma once

#include "shadow/geometry/map_block.h"

#include <math.h>
#include <string.h>

#include "shadow/geometry/map_facets.h"

#define HOLE_AWAY 0.5f /* texels: covers the centre, with a hole there */
#define WILD_AWAY 1.0f /* texels: triangles whose distance nobody works out */

enum { SQUARE = 4, SQUARES = TEXELS / (SQUARE * SQUARE) };

struct work {
    float nearest[TEXELS], rank[TEXELS];
    uint32_t id[TEXELS];
    float last[SQUARES]; /* of a square of texels, the rank that is last */
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

/* Those of a block's texels whose centre does not lie in a hole. */
static unsigned refuse_holes(const struct mark *k, uint32_t x, uint32_t y, unsigned covered)
{
    unsigned solid = covered;
    struct light_hit hit;
    for (; covered; covered &= covered - 1) {
        unsigned i = (unsigned)__builtin_ctz(covered);
        float px = k->left + (float)(x + i % BLOCK_COLUMNS) + 0.5f, py = k->top + (float)(y + i / BLOCK_COLUMNS) + 0.5f;
        if (!light_triangle_solid_hit(&k->map->mesh, k->holes, k->id, px, py, &hit))
            solid &= ~(1u << i);
    }
    return solid;
}

/* Which texels lie in the triangle's box. */
INLINE block_mask within_box(const struct map_facets *f, int lane, block_float x, block_float y)
{
    return block_at_least(x, block_all(f->left[lane])) & block_at_least(block_all(f->right[lane]), x) &
           block_at_least(y, block_all(f->top[lane])) & block_at_least(block_all(f->bottom[lane]), y);
}

INLINE void mark_block(const struct mark *k, uint32_t block)
{
    const struct map_facets *f = k->facets;
    const int lane = k->lane;
    const uint32_t left = block % 8 * BLOCK_COLUMNS, top = block / 8 * BLOCK_ROWS;
    block_float *nearest = (block_float *)k->work->nearest + block, *ranks = (block_float *)k->work->rank + block;
    block_uint *ids = (block_uint *)k->work->id + block;
    const block_float x = block_columns() + (float)left, y = block_rows() + (float)top;
    block_float inmost = {}, away = {};
    block_mask touched = within_box(f, lane, x, y);
#pragma GCC unroll 3
    for (int e = 0; e < 3; e++) {
        block_float edge = f->a[e][lane] * x + (f->b[e][lane] * y + f->c[e][lane]), distance = edge * f->inverse[e][lane];
        touched &= block_at_least(edge, block_all(f->least[e][lane]));
        inmost = e == 0 ? edge : block_min(inmost, edge);
        away = e == 0 ? distance : block_min(away, distance);
    }
    away = f->behind[lane] - __builtin_convertvector(__builtin_convertvector(away, block_int), block_float);
    block_mask covered = block_at_least(inmost, block_all(0));
    if (k->holes) {
        unsigned centers = block_bits(covered & touched), solid = refuse_holes(k, left, top, centers);
        covered = block_of_bits(solid);
        away = block_pick(block_of_bits(centers & ~solid), block_all(HOLE_AWAY * RANK_STEPS + f->behind[lane]), away);
    }
    block_float n = f->nx[lane] * x + (f->ny[lane] * y + f->n[lane]);
    block_float near = block_min(n + f->slack[lane], block_all(f->most[lane])), rank = block_pick(covered, -n, away);
    *nearest = block_pick(touched & block_above(near, *nearest), near, *nearest);
    block_mask better = touched & block_above(*ranks, rank);
    *ranks = block_pick(better, rank, *ranks);
    *ids = (block_uint)block_pick(better, (block_float)((block_uint){} + k->id), (block_float)*ids);
}

/* Of eight rows of eight, a bit each. */
INLINE uint64_t bits_between(int32_t x0, int32_t x1, int32_t y0, int32_t y1)
{
    uint64_t row = (2u << x1) - (1u << x0), rows = (UINT64_MAX << 8 * y0) & (UINT64_MAX >> (56 - 8 * y1));
    return row * (rows & 0x0101010101010101u);
}

typedef uint8_t row_bits __attribute__((vector_size(8)));

enum { WORD_ROWS = 8 * BLOCK_ROWS }; /* texels' that one such word of blocks holds */

/* The blocks of a word that hold something of the triangle's box, which reaches into the word. */
INLINE uint64_t boxed_blocks(const struct map_facets *f, int lane, int32_t word)
{
    int32_t top = f->y0[lane] - word * WORD_ROWS, bottom = f->y1[lane] - word * WORD_ROWS;
    return bits_between(f->x0[lane] / BLOCK_COLUMNS, f->x1[lane] / BLOCK_COLUMNS, top > 0 ? top / BLOCK_ROWS : 0,
                        bottom < WORD_ROWS ? bottom / BLOCK_ROWS : 7);
}

/* The blocks of a word that its edges leave, and a few more. */
INLINE uint64_t spanned_blocks(const struct map_facets *f, int lane, int32_t word)
{
    lanes top = (LANES_COUNT + (float)(8 * word)) * BLOCK_ROWS, bottom = top + (BLOCK_ROWS - 1);
    top = lanes_max(top, lanes_all(f->top[lane]));
    bottom = lanes_min(bottom, lanes_all(f->bottom[lane]));
    lanes from = lanes_all(f->left[lane]), to = lanes_all(f->right[lane]);
#pragma GCC unroll 3
    for (int e = 0; e < 3; e++) {
        lanes p = f->at_row[e][lane] + f->step[e][lane] * top, q = f->at_row[e][lane] + f->step[e][lane] * bottom;
        lanes least = lanes_min(p, q) + f->before[e][lane], most = lanes_max(p, q) + f->after[e][lane];
        from = lanes_max(from, least);
        to = lanes_min(to, most);
    }
    lane_ints some = (from <= to) & (top <= bottom);
    lane_ints first = __builtin_convertvector((lanes)((lane_ints)from & some), lane_ints) / BLOCK_COLUMNS;
    lane_ints last = __builtin_convertvector((lanes)((lane_ints)to & some), lane_ints) / BLOCK_COLUMNS;
    lane_ints bits = (((lane_ints){} + 2) << last) - (((lane_ints){} + 1) << first);
    return (uint64_t) __builtin_convertvector(bits & some, row_bits);
}

INLINE void mark_triangle(const struct mark *k)
{
    const struct map_facets *f = k->facets;
    int32_t first = f->y0[k->lane] / WORD_ROWS, last = f->y1[k->lane] / WORD_ROWS;
    for (int32_t word = first; word <= last; word++) {
        uint64_t blocks = f->wide[k->lane] ? spanned_blocks(f, k->lane, word) : boxed_blocks(f, k->lane, word);
        for (; blocks; blocks &= blocks - 1)
            mark_block(k, (uint32_t)(64 * word + __builtin_ctzll(blocks)));
    }
}

/* Finds of each square of the tile the rank that is last. */
static void find_last_ranks(struct work *w)
{
    for (uint32_t i = 0; i < SQUARES; i++) {
        uint32_t x = i % 8 * SQUARE, y = i / 8 * SQUARE;
        lanes_quarter last = *(const lanes_quarter *)&w->rank[block_place(x, y)];
        for (uint32_t row = y + 1; row < y + SQUARE; row++) {
            lanes_quarter next = *(const lanes_quarter *)&w->rank[block_place(x, row)];
            for (int k = 0; k < 4; k++)
                last[k] = next[k] > last[k] ? next[k] : last[k];
        }
        w->last[i] = CONSERVATIVE_MOST(last);
        w->last[i] = last[3] > w->last[i] ? last[3] : w->last[i];
    }
}

/* Whether all squares that hold something of the triangle's box are known to be nearer than its nearest corner: it would change nothing. Half of
 * a closed mesh. */
INLINE bool is_hidden(const struct map_facets *f, int lane, const struct work *w)
{
    block_float most = block_all(-f->most[lane]);
    uint64_t open = 0;
    for (int i = 0; i < SQUARES; i += BLOCK)
        open |= (uint64_t)block_bits(block_above(*(const block_float *)&w->last[i], most)) << i;
    return (open & bits_between(f->x0[lane] / SQUARE, f->x1[lane] / SQUARE, f->y0[lane] / SQUARE, f->y1[lane] / SQUARE)) == 0;
}

/* Up to eight triangles of a tile; lanes beyond `count` repeat the first. */
struct batch {
    uint32_t id[LANES];
    const struct light_part *part[LANES];
    struct light_triangle triangle[LANES];
    int count;
};

/* Numbers [first, first + 8) of the tile's, as far as there are. */
static void take_batch(const struct geometry_map *m, const uint32_t *triangles, size_t first, size_t end, uint32_t *hint,
                       struct batch *b)
{
    b->count = end - first < LANES ? (int)(end - first) : LANES;
    for (int i = 0; i < LANES; i++) {
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

/* test: for what is hidden by what find_last_ranks() found. */
static void mark_triangles(const struct geometry_map *m, const uint32_t *triangles, size_t count, bool test, float left,
                           float top, struct work *w)
{
    uint32_t hint = 0;
    for (size_t first = 0; first < count; first += LANES) {
        struct batch batch;
        struct map_facets f;
        take_batch(m, triangles, first, count, &hint, &batch);
        map_facets_box(&f, batch.triangle, left, top, MAP_TILE);
        unsigned open = lanes_bits(f.over) & ((1u << batch.count) - 1);
        for (unsigned rest = test ? open : 0; rest; rest &= rest - 1) {
            int i = __builtin_ctz(rest);
            open &= ~((unsigned)is_hidden(&f, i, w) << i);
        }
        if (!open)
            continue;
        map_facets_set(&f, m->mesh.nearest, MAP_TILE);
        if (lanes_bits(f.wide))
            map_facets_spans(&f);
        for (; open; open &= open - 1) {
            int i = __builtin_ctz(open);
            struct mark mark = {m, &f, i, batch.id[i], NULL, left, top, w};
            /* Thin in projection: may have no area at all, and casts nothing then. */
            if (f.thin[i] && light_part_degenerate(m->mesh.scene, batch.part[i], batch.id[i]))
                continue;
            mark.holes = batch.part[i]->holes ? batch.part[i] : NULL;
            mark_triangle(&mark);
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
    for (uint32_t y = 0; y < MAP_TILE; y++)
        for (uint32_t x = 0; x < MAP_TILE; x++)
            mark_wild_texel(m, part, &f, id, left + x + 0.5, top + y + 0.5, w, block_place(x, y));
}

typedef int32_t quarter_int __attribute__((vector_size(16), aligned(8), may_alias));

/* Nearest depths and triangles side by side, rows after rows. */
static void put_cells(const struct work *w, struct map_cell *cells)
{
    for (uint32_t y = 0; y < MAP_TILE; y++)
        for (uint32_t x = 0; x < MAP_TILE; x += BLOCK_COLUMNS) {
            uint32_t at = block_place(x, y);
            lanes_quarter nearest = *(const lanes_quarter *)&w->nearest[at], rank = *(const lanes_quarter *)&w->rank[at];
            quarter_int id = *(const quarter_int *)&w->id[at];
            id |= (rank >= 0) & (int32_t)MAP_OFF_EDGE;
            quarter_int *out = (quarter_int *)&cells[y * MAP_TILE + x];
            out[0] = __builtin_shufflevector((quarter_int)nearest, id, 0, 4, 1, 5);
            out[1] = __builtin_shufflevector((quarter_int)nearest, id, 2, 6, 3, 7);
        }
}

static void rasterize(const struct geometry_map *m, uint32_t tile_x, uint32_t tile_y, const uint32_t *triangles, size_t front,
                      size_t count, struct map_cell *cells)
{
    struct work w;
    float left = (float)(tile_x * MAP_TILE), top = (float)(tile_y * MAP_TILE);
    for (size_t i = 0; i < TEXELS; i++) {
        w.nearest[i] = -INFINITY;
        w.rank[i] = INFINITY;
        w.id[i] = MAP_NONE;
    }
    mark_triangles(m, triangles, front, false, left, top, &w);
    find_last_ranks(&w);
    mark_triangles(m, triangles + front, count - front, true, left, top, &w);
    for (size_t i = 0; i < m->wild_count; i++)
        mark_wild(m, m->wild[i], left, top, &w);
    put_cells(&w, cells);
}
