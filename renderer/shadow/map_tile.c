#include "shadow/map_tile.h"

#include <math.h>
#include <string.h>

#include "trace/hole.h"

#define INLINE static inline __attribute__((always_inline))

enum { TEXELS = MAP_TILE * MAP_TILE };

/* Ranks: below 0 over the centre, minus the nearness there; else the distance from the centre in steps, and within a step the nearer to the
 * light first: of two triangles that meet in an outline, the one that the light sees. The smaller is kept, of equals the first: a tile's triangles come in one order always. */
#define RANK_STEPS 8.0f /* a texel */
#define HOLE_AWAY  0.5f /* texels: covers the centre, with a hole there */
#define WILD_AWAY  1.0f /* texels: triangles whose distance nobody works out */

struct work {
    float nearest[TEXELS], rank[TEXELS];
    uint32_t id[TEXELS];
} __attribute__((aligned(64)));

/* A triangle over the tile. */
struct facet {
    struct conservative cover;
    float n, nx, ny;   /* nearness at texel (x, y)'s centre: n + nx x + ny y */
    float most, slack; /* the nearest corner's; by how much a texel may exceed its centre */
    float inverse[3];  /* RANK_STEPS / length of each edge */
    float behind;      /* in (0, 1): more for farther from the light */
    uint32_t id;
};

INLINE bool set_facet(const struct geometry_map *m, struct facet *f, const struct light_triangle *t, uint32_t id, float left,
                      float top)
{
    float x[3], y[3], n[3];
    for (int k = 0; k < 3; k++) {
        x[k] = t->corner[k]->x - left;
        y[k] = t->corner[k]->y - top;
        n[k] = t->corner[k]->n;
    }
    if (!conservative_setup(&f->cover, x, y, MAP_TILE, MAP_TILE))
        return false;
    f->id = id;
    f->most = CONSERVATIVE_MOST(n);
    float scale = f->cover.turn / f->cover.area;
    float u = n[1] - n[0], v = n[2] - n[0];
    f->nx = (u * (y[2] - y[0]) - v * (y[1] - y[0])) * scale;
    f->ny = (v * (x[1] - x[0]) - u * (x[2] - x[0])) * scale;
    f->n = n[0] + f->nx * (0.5f - x[0]) + f->ny * (0.5f - y[0]);
    /* What rounding makes of a slope is a fraction of it; the corners bound the rest. */
    f->slack = (0.5f + CONSERVATIVE_MARGIN) * (fabsf(f->nx) + fabsf(f->ny));
    f->slack += 0x1p-18f * (fabsf(f->nx) + fabsf(f->ny)) * (fabsf(x[0]) + fabsf(y[0]) + MAP_TILE);
    if (!(f->slack < INFINITY)) { /* seen edge-on */
        f->nx = f->ny = f->slack = 0;
        f->n = f->most;
    }
    f->behind = m->mesh.nearest / (m->mesh.nearest + (n[0] + n[1] + n[2]) * (1.0f / 3));
    for (int k = 0; k < 3; k++)
        f->inverse[k] = RANK_STEPS / sqrtf(f->cover.a[k] * f->cover.a[k] + f->cover.b[k] * f->cover.b[k] + 1e-30f);
    return true;
}

/* Macros, since vectors that functions return depend on the instruction set. */
#define LANES_IF(mask, a, b) ((lanes_float)(((mask) & (lanes_int)(a)) | (~(mask) & (lanes_int)(b))))
#define LANES_MAX(a, b)      LANES_IF((a) > (b), a, b)

/* Takes lanes whose centre lies in a hole out of `covered`. */
static void refuse_holes(const struct geometry_map *m, const struct light_part *part, uint32_t id, float left, float top,
                         int32_t *covered)
{
    struct light_hit hit;
    for (int i = 0; i < CONSERVATIVE_LANES; i++)
        if (covered[i] && !light_triangle_solid_hit(&m->mesh, part, id, left + (float)i + 0.5f, top + 0.5f, &hit))
            covered[i] = 0;
}

INLINE void mark_row(const struct facet *f, const struct geometry_map *m, const struct light_part *holes, float left, float top,
                     int32_t x, int32_t y, struct work *w)
{
    const struct conservative *c = &f->cover;
    lanes_float columns = LANES_COUNT + (float)x, edge[3];
    for (int k = 0; k < 3; k++)
        edge[k] = CONSERVATIVE_EDGE(c, k, columns, y);
    lanes_int touched = CONSERVATIVE_TOUCHED(c, edge, columns);
    lanes_int covered = (edge[0] >= 0) & (edge[1] >= 0) & (edge[2] >= 0);
    lanes_float n = f->nx * columns + (f->ny * (float)y + f->n);
    lanes_float away = -edge[0] * f->inverse[0], second = -edge[1] * f->inverse[1], third = -edge[2] * f->inverse[2];
    away = LANES_MAX(away, second);
    away = LANES_MAX(away, third);
    if (holes) {
        lanes_int before = covered & touched;
        covered = before;
        refuse_holes(m, holes, f->id, left + (float)x, top + (float)y, (int32_t *)&covered);
        away = LANES_IF(before & ~covered, (lanes_float){} + HOLE_AWAY * RANK_STEPS, away);
    }
    away = __builtin_convertvector(__builtin_convertvector(away, lanes_int), lanes_float) + f->behind;
    lanes_float near = n + f->slack, most = (lanes_float){} + f->most, rank = LANES_IF(covered, -n, away);
    near = LANES_IF(near < most, near, most);
    size_t at = (size_t)y * MAP_TILE + (size_t)x;
    lanes_float *nearest = (lanes_float *)&w->nearest[at], *ranks = (lanes_float *)&w->rank[at];
    lanes_uint *ids = (lanes_uint *)&w->id[at];
    *nearest = LANES_IF(touched & (near > *nearest), near, *nearest);
    lanes_int better = touched & (rank < *ranks);
    *ranks = LANES_IF(better, rank, *ranks);
    *ids = (lanes_uint)LANES_IF(better, (lanes_float)((lanes_uint){} + f->id), (lanes_float)*ids);
}

/* What of row y the edges leave, a little more than less: most of a long thin triangle's box is empty. */
struct spans {
    float at[3], step[3]; /* edge k crosses row y at at + step y */
    bool left[3], right[3];
};

INLINE struct spans find_spans(const struct conservative *c)
{
    struct spans s;
    for (int k = 0; k < 3; k++) {
        float inverse = 1 / c->a[k];
        s.at[k] = -(c->c[k] + c->reach[k]) * inverse;
        s.step[k] = -c->b[k] * inverse;
        /* Steep enough that the crossing is sure to within a texel. */
        s.left[k] = c->a[k] > 0 && fabsf(s.at[k]) < 1e5f && fabsf(s.step[k]) < 1e3f;
        s.right[k] = c->a[k] < 0 && fabsf(s.at[k]) < 1e5f && fabsf(s.step[k]) < 1e3f;
    }
    return s;
}

INLINE void mark_facet(const struct facet *f, const struct geometry_map *m, const struct light_part *holes, float left, float top,
                       struct work *w)
{
    const struct conservative *c = &f->cover;
    int32_t x0 = c->x0 & ~(CONSERVATIVE_LANES - 1);
    if (c->x1 - x0 < CONSERVATIVE_LANES) {
        for (int32_t y = c->y0; y <= c->y1; y++)
            mark_row(f, m, holes, left, top, x0, y, w);
        return;
    }
    struct spans s = find_spans(c);
    for (int32_t y = c->y0; y <= c->y1; y++) {
        float from = (float)c->x0, to = (float)c->x1;
        for (int k = 0; k < 3; k++) {
            float cross = s.at[k] + s.step[k] * (float)y;
            from = s.left[k] && cross - 1 > from ? cross - 1 : from;
            to = s.right[k] && cross + 1 < to ? cross + 1 : to;
        }
        if (!(from <= to))
            continue;
        for (int32_t x = (int32_t)from & ~(CONSERVATIVE_LANES - 1); x <= (int32_t)to; x += CONSERVATIVE_LANES)
            mark_row(f, m, holes, left, top, x, y, w);
    }
}

/* Thin in projection: may have no area at all, and casts nothing then. */
INLINE bool is_nothing(const struct geometry_map *m, const struct light_part *part, const struct facet *f)
{
    float longest = CONSERVATIVE_LEAST(f->inverse) * (1 / RANK_STEPS), area = f->cover.area;
    return (area * longest * longest <= 1e-4f || area <= 1e-6f) && light_part_degenerate(m->mesh.scene, part, f->id);
}

/* Whether everything in the triangle's box is known to be nearer than its nearest corner: it would change nothing. Half of a closed mesh. */
INLINE bool is_hidden(const struct light_triangle *t, float left, float top, const struct work *w)
{
    float x[3], y[3], n[3];
    for (int k = 0; k < 3; k++) {
        x[k] = t->corner[k]->x - left;
        y[k] = t->corner[k]->y - top;
        n[k] = t->corner[k]->n;
    }
    const float m = CONSERVATIVE_MARGIN, side = MAP_TILE - 1;
    float x0 = CONSERVATIVE_LEAST(x) - m, x1 = CONSERVATIVE_MOST(x) + m, y0 = CONSERVATIVE_LEAST(y) - m,
          y1 = CONSERVATIVE_MOST(y) + m;
    int32_t column = x0 > 0 ? (int32_t)x0 : 0, end = x1 < side ? (int32_t)x1 : (int32_t)side;
    int32_t row = y0 > 0 ? (int32_t)y0 : 0, bottom = y1 < side ? (int32_t)y1 : (int32_t)side;
    if (end - (column & ~(CONSERVATIVE_LANES - 1)) >= CONSERVATIVE_LANES)
        return false; /* not worth the look */
    lanes_float most = (lanes_float){} + CONSERVATIVE_MOST(n);
    lanes_int open = {};
    int32_t first = column & ~(CONSERVATIVE_LANES - 1), any = 0;
    lanes_float columns = LANES_COUNT + (float)first;
    for (; row <= bottom; row++) {
        const lanes_float *rank = (const lanes_float *)&w->rank[row * (int32_t)MAP_TILE + first];
        open |= -*rank < most;
    }
    open &= (columns >= (float)column) & (columns <= (float)end);
    for (int k = 0; k < CONSERVATIVE_LANES; k++)
        any |= open[k];
    return !any;
}

INLINE void mark_triangles(const struct geometry_map *m, const uint32_t *triangles, size_t count, float left, float top,
                           struct work *w)
{
    uint32_t hint = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t id = triangles[i];
        const struct light_part *part = light_mesh_part(&m->mesh, id, &hint);
        if (i + LIGHT_INDICES_AHEAD < count)
            light_part_prefetch_indices(part, triangles[i + LIGHT_INDICES_AHEAD]);
        if (i + LIGHT_VERTICES_AHEAD < count)
            light_part_prefetch_vertices(part, triangles[i + LIGHT_VERTICES_AHEAD]);
        struct light_triangle t = light_part_triangle(part, id);
        struct facet f;
        if (is_hidden(&t, left, top, w))
            continue;
        if (!set_facet(m, &f, &t, id, left, top) || is_nothing(m, part, &f))
            continue;
        if (part->holes)
            mark_facet(&f, m, part, left, top, w);
        else
            mark_facet(&f, m, NULL, left, top, w);
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

INLINE void rasterize(const struct geometry_map *m, uint32_t tile_x, uint32_t tile_y, const uint32_t *triangles, size_t count,
                      struct map_cell *cells)
{
    struct work w;
    float left = (float)(tile_x * MAP_TILE), top = (float)(tile_y * MAP_TILE);
    for (int i = 0; i < TEXELS; i++) {
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

#ifdef __x86_64__
/* The same arithmetic in wider vectors (no contraction), so the same bits. */
__attribute__((target("avx2"))) static void rasterize_avx2(const struct geometry_map *m, uint32_t tile_x, uint32_t tile_y,
                                                           const uint32_t *triangles, size_t count, struct map_cell *cells)
{
    rasterize(m, tile_x, tile_y, triangles, count, cells);
}
#endif

static void rasterize_any(const struct geometry_map *m, uint32_t tile_x, uint32_t tile_y, const uint32_t *triangles, size_t count,
                          struct map_cell *cells)
{
    rasterize(m, tile_x, tile_y, triangles, count, cells);
}

void map_tile_rasterize(const struct geometry_map *m, uint32_t tile_x, uint32_t tile_y, const uint32_t *triangles, size_t count,
                        struct map_cell *cells)
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        rasterize_avx2(m, tile_x, tile_y, triangles, count, cells);
        return;
    }
#endif
    rasterize_any(m, tile_x, tile_y, triangles, count, cells);
}
