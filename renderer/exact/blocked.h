/* A tile's code: which samples of a receiver in one pixel are shadowed. */
#pragma once

#include <stdatomic.h>

#include "exact/receivers.h"

/* G of four lines within a pixel: G(x, y) = g + x gx + y gy for x, y in [0, 1]; off by at most `error`. */
struct pixel_lines {
    lane4 g, gx, gy, error;
};

static inline __attribute__((always_inline)) void pixel_lines_make(struct pixel_lines *p, const struct occluder *o,
                                                                   const struct receiver *r, double x, double y)
{
    lane4 v = o->lines.v + x * o->lines.vx + y * o->lines.vy;
    double rv = r->v + x * r->vx + y * r->vy;
    p->g = o->lines.fixed * rv - r->fixed * v;
    p->gx = o->lines.fixed * r->vx - r->fixed * o->lines.vx;
    p->gy = o->lines.fixed * r->vy - r->fixed * o->lines.vy;
    p->error = LINE_ROUNDING * (o->lines.fixed_size * r->v_size + r->fixed_size * o->lines.v_size) + LINE_UNDERFLOW;
}

/* Single precision: rounding of three coefficients, two products and two sums of terms no larger than |g| + |gx| + |gy| is below
 * 5 x 2^-24 of that; 2^-20 is used. */
#define SINGLE_ROUNDING  0x1p-20
#define SINGLE_UNDERFLOW 1e-37

struct samples_sure {
    uint32_t inside, outside;
};

/* Samples at which `count` lines are all certainly positive, and those at which some is certainly negative. */
static inline __attribute__((always_inline)) struct samples_sure evaluate(const struct tile_scratch *s,
                                                                          const struct pixel_lines *p, int count)
{
    struct samples_sure sure = {0, 0};
    lane4 room =
        (lane_abs(p->g) + lane_abs(p->gx) + lane_abs(p->gy)) * SINGLE_ROUNDING + p->error * (1 + 0x1p-20) + SINGLE_UNDERFLOW;
    for (int i = 0; i < 32; i += WIDTH) {
        unsigned in = ~0u, out = 0;
        wide x = wide_load(s->x + i), y = wide_load(s->y + i);
        for (int k = 0; k < count; k++) {
            wide value = wide_add(wide_add(wide_all((float)p->g[k]), wide_mul(wide_all((float)p->gx[k]), x)),
                                  wide_mul(wide_all((float)p->gy[k]), y));
            in &= wide_above(value, wide_all((float)room[k]));
            out |= wide_above(wide_all(-(float)room[k]), value);
        }
        const unsigned lanes = WIDTH == 32 ? ~0u : (1u << WIDTH % 32) - 1;
        sure.inside |= (in & lanes) << i;
        sure.outside |= (out & lanes) << i;
    }
    return sure;
}

/* The lines' signs in the whole pixel: 1 all positive, -1 one negative, 0 neither. `count_mask`: which lanes count. */
static inline __attribute__((always_inline)) int whole_pixel(const struct pixel_lines *p, unsigned count_mask)
{
    const lane4 zero = {0, 0, 0, 0};
    lane4 rise = lanes_max(p->gx, zero) + lanes_max(p->gy, zero), most = p->g + rise,
          least = most - lane_abs(p->gx) - lane_abs(p->gy);
    lane4 room = p->error + 0x1p-50 * (lane_abs(p->g) + lane_abs(p->gx) + lane_abs(p->gy)), under = -room;
    if (lanes_above(&under, &most) & count_mask)
        return -1;
    return (lanes_above(&least, &room) & count_mask) == count_mask;
}

/* Sign in double of lines at one sample: 1 all positive, -1 one negative, 0 neither certain. */
static inline int at_sample(const struct pixel_lines *p, double x, double y, unsigned count_mask)
{
    lane4 value = p->g + x * p->gx + y * p->gy;
    lane4 room = p->error + 0x1p-50 * (lane_abs(p->g) + lane_abs(p->gx) + lane_abs(p->gy)), under = -room;
    if (lanes_above(&under, &value) & count_mask)
        return -1;
    return (lanes_above(&value, &room) & count_mask) == count_mask;
}

/* A group of samples of one pixel with one receiver, while occluders are tried. */
struct group {
    struct tile_scratch *scratch;
    const struct tile_job *job;
    const struct receiver *receiver;
    const struct light_box *box;
    uint32_t x, y;
    uint32_t open;            /* samples not yet shadowed */
    bool center;              /* one sample, the pixel's centre (bit 0), else view_samples32 */
    bool anywhere;            /* it need not lie in its triangle: the camera pass may round */
    bool certain;             /* the receiver's lines say where its points are */
    struct receiver *collect; /* put candidates there instead of trying them */
    struct blockers blockers; /* what has taken samples out of `open` */
};

static inline struct sample_ray group_ray(const struct group *g, unsigned sample)
{
    return g->center
               ? sample_ray(g->job->view, g->x + 0.5, g->y + 0.5)
               : sample_ray(g->job->view, g->x + (double)view_samples32[sample][0], g->y + (double)view_samples32[sample][1]);
}

/* Where the pixel's part of the receiver's plane lies, for hole_error(): the largest sums of absolute components of P - a and of P - L, and
 * P's own error. False where it is not known. */
static inline bool pixel_distances(const struct group *g, struct dvec3 a, double *from_a, double *from_light, double *error)
{
    struct quad q;
    const struct exact_apex *l = &g->job->to_light;
    if (!quad_make(&q, g->job, g->receiver, g->x, g->y, 1))
        return false;
    *error = 4 * q.slack;
    *from_a = lane_most(lane_abs(q.x - a.x) + lane_abs(q.y - a.y) + lane_abs(q.z - a.z)) + *error;
    *from_light = l->infinite ? fabs(l->v.x) + fabs(l->v.y) + fabs(l->v.z)
                              : lane_most(lane_abs(q.x - l->v.x) + lane_abs(q.y - l->v.y) + lane_abs(q.z - l->v.z)) + *error;
    return true;
}

/* Of the samples of `inside`, all of which cross `o`: those where its mask is solid; the others but `unsure` are not shadowed by it. */
static inline void mask_samples(struct group *g, const struct occluder *o, const struct pixel_lines *p, uint32_t inside,
                                uint32_t *solid, uint32_t *unsure)
{
    const struct masked *m = masked_get(g->scratch, g->job, o);
    const struct receiver *r = g->receiver;
    double from_a, from_light, error;
    *solid = 0;
    *unsure = inside;
    if (!m->map.mask || !pixel_distances(g, m->a, &from_a, &from_light, &error))
        return;
    lane4 off = (p->error + 0x1p-50 * (lane_abs(p->g) + lane_abs(p->gx) + lane_abs(p->gy))) * m->unscale;
    /* G is m . (P - a) times this. */
    double factor =
        g->job->view->orthographic ? fabs(r->fixed) : fabs(r->v + g->x * r->vx + g->y * r->vy) + fabs(r->vx) + fabs(r->vy);
    struct hole_lines lines = {p->g * m->unscale, p->gx * m->unscale, p->gy * m->unscale,
                               2.4 * (off[0] + off[1] + off[2]) + 1.01 * factor * hole_error(m, from_a, from_light, error)};
    hole_samples(g->scratch, &m->map, &lines, inside, solid, unsure);
}

/* Samples that neither single precision nor the mask's absence decides. */
static inline void try_one_by_one(struct group *g, const struct occluder *o, const struct pixel_lines *p, uint32_t inside,
                                  uint32_t unsure, bool lines_count)
{
    struct slow *slow = &g->scratch->slow;
    bool holes = g->job->triangles->flags[o->id] & TRIANGLE_HOLES;
    uint32_t id = g->receiver->id, to_read = holes ? inside : 0;
    if (holes && lines_count && inside) {
        uint32_t solid;
        mask_samples(g, o, p, inside, &solid, &to_read);
        g->open &= ~solid;
    }
    g->scratch->counts.undecided += (unsigned)__builtin_popcount(unsure);
    for (uint32_t bits = unsure | to_read; bits; bits &= bits - 1) {
        unsigned i = (unsigned)__builtin_ctz(bits);
        struct sample_ray ray = group_ray(g, i);
        int sign = inside >> i & 1 ? 1
                   : lines_count   ? at_sample(p, g->center ? 0.5 : (double)view_samples32[i][0],
                                             g->center ? 0.5 : (double)view_samples32[i][1], 15)
                                   : 0;
        bool blocked = sign > 0   ? !holes || slow_is_solid(slow, &ray, id, o->id)
                       : sign < 0 ? false
                                  : slow_blocks(slow, &ray, id, o->id, o->side);
        g->open &= ~((uint32_t)blocked << i);
    }
    if (!holes)
        g->open &= ~inside;
}

static inline void group_collect(struct group *g, uint32_t id)
{
    struct receiver *r = g->collect;
    if (cannot_shadow(r, g->job, id, false) || is_on_lit_side(r, g->job, id))
        return;
    if (r->candidate_count == CANDIDATES_MAX) {
        r->candidate_count = CANDIDATES_MANY;
        g->open = 0;
        return;
    }
    r->candidates[r->candidate_count++] = id;
}

static inline void group_try_occluder(struct group *g, const struct occluder *o)
{
    struct pixel_lines p = {.g = {0}};
    g->scratch->counts.tests++;
    if (!g->certain) {
        try_one_by_one(g, o, &p, 0, g->open, false);
        return;
    }
    pixel_lines_make(&p, o, g->receiver, g->x, g->y);
    if (g->center) {
        int sign = at_sample(&p, 0.5, 0.5, 15);
        if (sign >= 0)
            try_one_by_one(g, o, &p, sign > 0, sign == 0, false);
        return;
    }
    int whole = whole_pixel(&p, 15);
    if (whole < 0)
        return;
    struct samples_sure sure = whole > 0 ? (struct samples_sure){~0u, 0} : evaluate(g->scratch, &p, 4);
    try_one_by_one(g, o, &p, sure.inside & g->open, g->open & ~(sure.inside | sure.outside), true);
}

/* `certain_to_try`: cannot_shadow() has been asked, or does not matter. */
static inline void group_try(struct group *g, uint32_t id, bool certain_to_try)
{
    if (!certain_to_try && cannot_shadow(g->receiver, g->job, id, g->anywhere))
        return;
    const struct occluder *o = occluder_get(g->scratch, g->job, id);
    uint32_t before = g->open;
    if (o->side == 0)
        return;
    group_try_occluder(g, o);
    if (g->open != before && g->blockers.count < BLOCKERS_KEPT)
        g->blockers.ids[g->blockers.count++] = id;
}

/* Tries what shadowed all of the receiver elsewhere, as long as it shadows something here. */
static inline void group_try_recent(struct group *g)
{
    const struct blockers *recent = &g->receiver->recent;
    unsigned useless = 0;
    for (unsigned i = 0; i < recent->count && g->open && useless < 2; i++) {
        uint32_t before = g->open;
        group_try(g, recent->ids[i], true);
        useless += g->open == before;
    }
}

/* Remembers for the receiver's other pixels, and for other pictures, what shadowed this one wholly. */
static inline void group_was_shadowed(const struct group *g, struct receiver *r)
{
    r->recent = g->blockers;
    if (r->candidate_area == AREA_PICTURE && r->candidate_count == CANDIDATES_MANY)
        light_learn(g->job->grid, r, LIGHT_MANY, g->blockers.ids, g->blockers.count);
}

/* The boxes from `from` to `to` of the grid's arrays, which may shadow what lies in g->box. */
static inline void group_try_run(struct group *g, uint32_t from, uint32_t to)
{
    const struct light_grid *grid = g->job->grid;
    const struct light_box *box = g->box;
    const wide u0 = wide_all(box->u0), u1 = wide_all(box->u1), v0 = wide_all(box->v0), v1 = wide_all(box->v1),
               far = wide_all(box->far);
    const unsigned all = WIDTH == 32 ? ~0u : (1u << WIDTH % 32) - 1;
    for (uint32_t i = from; i < to; i += WIDTH) {
        unsigned apart = wide_above(wide_load(grid->u0 + i), u1) | wide_above(u0, wide_load(grid->u1 + i)) |
                         wide_above(wide_load(grid->v0 + i), v1) | wide_above(v0, wide_load(grid->v1 + i)) |
                         wide_above(wide_load(grid->near + i), far);
        unsigned meet = ~apart & all;
        if (to - i < WIDTH)
            meet &= (1u << (to - i)) - 1;
        for (; meet; meet &= meet - 1) {
            uint32_t id = grid->ids[i + (unsigned)__builtin_ctz(meet)];
            if (id == g->receiver->id)
                continue;
            if (g->collect)
                group_collect(g, id);
            else
                group_try(g, id, false);
            if (!g->open)
                return;
        }
    }
}

/* x - reach, certainly not rounded up. */
static inline float less(float x, float reach)
{
    float y = x - reach;
    return y - (fabsf(x) + reach) * 0x1p-22f;
}

/* Levels with boxes near g->box. */
static inline uint32_t levels_near(const struct group *g, unsigned f, uint32_t x0, uint32_t x1, uint32_t y0, uint32_t y1)
{
    const struct light_grid *grid = g->job->grid;
    const struct light_face *face = &grid->faces[f];
    uint32_t side = light_blocks(face), levels = face->everywhere;
    const _Atomic uint16_t *blocks = grid->blocks + (size_t)f * side * side;
    x0 >>= LIGHT_BLOCK_SHIFT, x1 >>= LIGHT_BLOCK_SHIFT, y0 >>= LIGHT_BLOCK_SHIFT, y1 >>= LIGHT_BLOCK_SHIFT;
    if ((x1 - x0 + 1) * (uint64_t)(y1 - y0 + 1) > 64)
        return face->occupied;
    for (uint32_t y = y0; y <= y1; y++)
        for (uint32_t x = x0; x <= x1; x++)
            levels |= atomic_load_explicit(&blocks[y * side + x], memory_order_relaxed);
    return levels;
}

static inline void group_try_face(struct group *g, unsigned f)
{
    const struct light_face *face = &g->job->grid->faces[f];
    const struct light_box *box = g->box;
    const uint32_t *first = g->job->grid->first;
    const uint32_t x0 = light_cell(box->u0, face->u_start, face->u_scale, face->side),
                   y0 = light_cell(box->v0, face->v_start, face->v_scale, face->side),
                   x1 = light_cell(box->u1, face->u_start, face->u_scale, face->side),
                   y1 = light_cell(box->v1, face->v_start, face->v_scale, face->side);
    for (uint32_t levels = levels_near(g, f, x0, x1, y0, y1); levels; levels &= levels - 1) {
        unsigned level = (unsigned)__builtin_ctz(levels);
        uint32_t side = face->side >> level, base = face->level_first[level], from = 0, row = 0;
        if (side > 1) {
            from = light_cell(less(box->u0, face->reach_u[level]), face->u_start, face->u_scale, face->side) >> level;
            row = light_cell(less(box->v0, face->reach_v[level]), face->v_start, face->v_scale, face->side) >> level;
        }
        for (; row <= y1 >> level && g->open; row++) {
            const uint32_t *cells = first + base + row * side;
            group_try_run(g, cells[from], cells[(x1 >> level) + 1]);
        }
    }
}

/* Whether a receiver is small enough for what may shadow it to be found once, for all its pixels. */
static inline bool is_small(const struct light_face *face, const struct light_box *box)
{
    return (box->u1 - box->u0) * face->u_scale < 4 && (box->v1 - box->v0) * face->v_scale < 4;
}

static inline unsigned faces_for(const struct group *g)
{
    return g->anywhere ? (1u << g->job->grid->face_count) - 1 : g->receiver->faces_met;
}

static inline void learn_candidates(const struct light_grid *grid, const struct receiver *r)
{
    if (r->candidate_count <= 0)
        light_learn(grid, r, r->candidate_count == 0 ? LIGHT_NOTHING : LIGHT_MANY, NULL, 0);
    else if (r->candidate_count <= LIGHT_OTHERS)
        light_learn(grid, r, LIGHT_FEW, r->candidates, (unsigned)r->candidate_count);
}

/* Finds what may shadow the receiver within `quad` (NULL: anywhere). */
static inline void find_candidates(const struct group *g, struct receiver *r, uint32_t area, const struct quad *quad)
{
    struct group all = *g;
    all.collect = r;
    all.open = 1;
    r->candidate_area = area;
    r->candidate_count = 0;
    for (unsigned faces = faces_for(g); faces && all.open; faces &= faces - 1) {
        unsigned f = (unsigned)__builtin_ctz(faces);
        struct light_box box;
        if (!query_box(g->job, g->anywhere ? NULL : &r->boxes[f], f, quad, &box))
            continue;
        all.box = &box;
        group_try_face(&all, f);
    }
    if (area == AREA_PICTURE)
        learn_candidates(g->job->grid, r);
}

static inline bool is_small_everywhere(const struct tile_job *job, const struct receiver *r)
{
    for (unsigned faces = r->faces_met; faces; faces &= faces - 1)
        if (!is_small(&job->grid->faces[__builtin_ctz(faces)], &r->boxes[__builtin_ctz(faces)]))
            return false;
    return true;
}

/* Finds candidates for the largest area around the pixel that has few: the picture if the receiver is small, else its tile, else its block.
 * False when even that has too many, or the point may lie anywhere. */
static inline bool candidates_ready(const struct group *g, struct receiver *r, uint32_t tile)
{
    if (g->anywhere)
        return false;
    if (r->candidate_area == AREA_PICTURE)
        return r->candidate_count >= 0;
    uint32_t tile_area = tile * AREAS_PER_TILE, tx = g->x % TILE_SIDE, ty = g->y % TILE_SIDE;
    uint32_t block_area = tile_area + 1 + ty / BLOCK_SIDE * BLOCKS_PER_ROW + tx / BLOCK_SIDE;
    struct quad quad;
    receiver_boxes(r, g->scratch, g->job);
    if (r->candidate_area == tile_area || r->candidate_area == block_area)
        return r->candidate_count >= 0;
    if (r->crowded_tile != tile) {
        if (is_small_everywhere(g->job, r)) {
            find_candidates(g, r, AREA_PICTURE, NULL);
            return r->candidate_count >= 0;
        }
        if (!r->certain || !quad_make(&quad, g->job, r, g->x - tx, g->y - ty, TILE_SIDE))
            return false;
        find_candidates(g, r, tile_area, &quad);
        if (r->candidate_count >= 0)
            return true;
        r->crowded_tile = tile;
    }
    if (!quad_make(&quad, g->job, r, g->x - tx % BLOCK_SIDE, g->y - ty % BLOCK_SIDE, BLOCK_SIDE))
        return false;
    find_candidates(g, r, block_area, &quad);
    return r->candidate_count >= 0;
}

/* Takes the shadowed samples out of g->open. `quad`: where they lie; NULL: not known. */
static inline void group_cast(struct group *g, struct receiver *r, const struct quad *quad)
{
    receiver_boxes(r, g->scratch, g->job);
    for (unsigned faces = faces_for(g); faces && g->open; faces &= faces - 1) {
        unsigned f = (unsigned)__builtin_ctz(faces);
        struct light_box box;
        if (!query_box(g->job, g->anywhere ? NULL : &r->boxes[f], f, quad, &box))
            continue;
        g->box = &box;
        group_try_face(g, f);
    }
}
