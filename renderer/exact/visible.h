/* A tile's code: which triangle each of the 32 samples of each pixel sees. Nearer has the larger key: 1 / t in perspective, -t else, both
 * linear in the picture. */
#pragma once

#include <string.h>

#include "exact/blocked.h"

/* A triangle being put into a tile. */
struct shown {
    uint32_t id;
    bool certain; /* its lines and keys mean something */
    bool holes;
    bool between;           /* wholly between near and far */
    lane4 v, vx, vy, error; /* edges, positive inside; lane 3 always */
    double key, key_x, key_y, key_error;
};

static inline bool between_planes(const struct view *v, const struct dvec3 c[3])
{
    for (int i = 0; i < 3; i++) {
        struct dvec3 d = dvec3_sub(c[i], v->eye);
        double z = dvec3_dot(d, v->forward), room = 1e-9 * (fabs(d.x) + fabs(d.y) + fabs(d.z));
        if (!(z - room > v->near && z + room < v->far))
            return false;
    }
    return true;
}

/* For show_solid(). */
static inline void shown_mask_make(struct masked *m, const struct tile_job *job, const struct lines *l, uint32_t id)
{
    masked_make(m, job, id);
    m->unscale = l->v_size + LINE_UNDERFLOW;
}

/* False when the camera certainly does not see it. */
static inline bool shown_make(struct shown *t, const struct tile_job *job, struct masked *mask, uint32_t id)
{
    struct dvec3 c[3];
    struct forms forms;
    struct lines l;
    struct exact_apex eye = eye_of(job->view);
    unsigned flags = job->triangles->flags[id];
    triangle_corners(job->triangles, id, c);
    forms_make(&forms, &eye, &c[0], &c[1], &c[2]);
    lines_make(&l, &forms, &job->screen);
    double fixed = l.fixed[3], fixed_error = LINE_ROUNDING * l.fixed_size[3] + LINE_UNDERFLOW;
    bool flat = job->view->orthographic;
    *t = (struct shown){.id = id};
    t->certain = fabs(fixed) > 4 * fixed_error;
    t->holes = flags & TRIANGLE_HOLES;
    t->between = between_planes(job->view, c);
    if (!t->certain)
        return true;
    int slope = (fixed > 0) == flat ? 1 : -1;
    if (slope == (flags & TRIANGLE_HIDDEN_BACK ? 1 : flags & TRIANGLE_HIDDEN_MIRRORED ? -1 : 0))
        return false;
    double turn = fixed > 0 ? 1 : -1, along = (flat ? 1 : -1) / fixed;
    lane4 scale = turn / (l.v_size + LINE_UNDERFLOW);
    t->v = l.v * scale, t->vx = l.vx * scale, t->vy = l.vy * scale;
    t->error = l.v_size * lane_abs(scale) * LINE_ROUNDING + LINE_UNDERFLOW;
    t->v[3] = 1, t->vx[3] = t->vy[3] = 0, t->error[3] = 0;
    t->key = l.v[3] * along, t->key_x = l.vx[3] * along, t->key_y = l.vy[3] * along;
    /* 4 fixed_error < |fixed|, so the relative error of 1 / fixed is less than 4/3 of fixed_error / |fixed|. */
    if (t->holes)
        shown_mask_make(mask, job, &l, id);
    t->key_error = 2 * (LINE_ROUNDING * l.v_size[3] + l.v_size[3] * fixed_error / fabs(fixed)) / fabs(fixed);
    return true;
}

/* What is known of samples that a triangle may have in a pixel. */
struct contest {
    uint32_t crossed; /* it certainly crosses them */
    uint32_t won;     /* and is certainly the nearest yet, between near and far: but for its mask it has them */
    float keys[32], error;
};

static inline void update_farthest(struct tile_scratch *s, uint32_t pixel)
{
    wide least = wide_load(s->key[pixel]);
    for (int i = WIDTH; i < 32; i += WIDTH)
        least = wide_min(least, wide_load(s->key[pixel] + i));
    s->farthest[pixel] = less(wide_least(least), s->key_error[pixel]);
}

/* Samples of `bits` that the triangle has now, decided one by one. */
static inline void show_slowly(struct tile_scratch *s, const struct tile_job *job, const struct shown *t, uint32_t pixel,
                               uint32_t x, uint32_t y, uint32_t bits, const struct contest *c)
{
    uint32_t *ids = s->id[pixel];
    for (; bits; bits &= bits - 1) {
        unsigned i = (unsigned)__builtin_ctz(bits);
        struct sample_ray ray = sample_ray(job->view, x + (double)view_samples32[i][0], y + (double)view_samples32[i][1]);
        if (c->won >> i & 1) {
            if (!slow_sees_solid(&s->slow, &ray, t->id))
                continue;
        } else if ((!(c->crossed >> i & 1) && !slow_crosses(&s->slow, &ray, t->id)) || !slow_meets(&s->slow, &ray, t->id) ||
                   (ids[i] != SCENE_NONE && !slow_is_before(&s->slow, &ray, t->id, ids[i]))) {
            continue;
        }
        ids[i] = t->id;
        s->key[pixel][i] = t->certain ? c->keys[i] : 0;
        if (!(c->error <= s->key_error[pixel]))
            s->key_error[pixel] = c->error;
    }
    update_farthest(s, pixel);
}

/* True when all keys from `low` to `high` are certainly those of points between near and far. */
static inline bool keys_between(const struct view *v, double low, double high)
{
    double nearest = v->orthographic ? -v->near : 1 / v->near, farthest = v->orthographic ? -v->far : 1 / v->far;
    return low > farthest + 1e-12 * fabs(farthest) && high < nearest - 1e-12 * fabs(nearest);
}

/* Gives the triangle those samples of `won` where its mask is solid; returns those that must be asked one by one. */
static inline uint32_t show_solid(struct tile_scratch *s, const struct tile_job *job, const struct shown *t, uint32_t pixel,
                                  const struct pixel_lines *p, const struct contest *c)
{
    const struct masked *m = &s->shown_mask;
    const struct screen *screen = &job->screen;
    const struct dvec3 *a = &m->a, *o = &job->view->eye;
    uint32_t solid, unsure;
    if (!m->map.mask)
        return c->won;
    double from_a = job->view->orthographic ? 3 * screen->size + fabs(a->x) + fabs(a->y) + fabs(a->z)
                                            : fabs(a->x - o->x) + fabs(a->y - o->y) + fabs(a->z - o->z);
    lane4 off = (p->error + 0x1p-50 * (lane_abs(p->g) + lane_abs(p->gx) + lane_abs(p->gy))) * m->unscale;
    /* The direction's components are at most screen.size, or 1. */
    struct hole_lines lines = {p->g * m->unscale, p->gx * m->unscale, p->gy * m->unscale,
                               2.4 * (off[0] + off[1] + off[2]) + hole_error(m, from_a, 3 * screen->size + 3, 0)};
    hole_samples(s, &m->map, &lines, c->won, &solid, &unsure);
    for (int i = 0; i < 32; i += WIDTH) {
        unsigned take = solid >> i & (unsigned)((1ull << WIDTH) - 1);
        wide_put(s->key[pixel] + i, wide_load(c->keys + i), take);
        wide_put_id(s->id[pixel] + i, t->id, take);
    }
    if (solid && !(c->error <= s->key_error[pixel]))
        s->key_error[pixel] = c->error;
    if (solid)
        update_farthest(s, pixel);
    return unsure;
}

static inline void show_in_pixel(struct tile_scratch *s, const struct tile_job *job, const struct shown *t, uint32_t pixel,
                                 uint32_t x, uint32_t y)
{
    struct contest contest = {.error = INFINITY};
    if (!t->certain) {
        show_slowly(s, job, t, pixel, x, y, ~0u, &contest);
        return;
    }
    struct pixel_lines p = {.g = t->v + (double)x * t->vx + (double)y * t->vy, .gx = t->vx, .gy = t->vy, .error = t->error};
    int whole = whole_pixel(&p, 7);
    if (whole < 0)
        return;
    struct samples_sure sure = whole > 0 ? (struct samples_sure){~0u, 0} : evaluate(s, &p, 3);
    uint32_t unsure = ~(sure.inside | sure.outside);
    if (!(sure.inside | unsure))
        return;
    double key = t->key + x * t->key_x + y * t->key_y;
    float own = (float)(t->key_error + (fabs(key) + fabs(t->key_x) + fabs(t->key_y)) * SINGLE_ROUNDING + SINGLE_UNDERFLOW);
    bool between = t->between;
    if (!between) {
        double rise = (t->key_x > 0 ? t->key_x : 0) + (t->key_y > 0 ? t->key_y : 0);
        between = keys_between(job->view, key + rise - fabs(t->key_x) - fabs(t->key_y) - (double)own, key + rise + (double)own);
    }
    bool plain = between && !t->holes;
    float error = own > s->key_error[pixel] ? own : s->key_error[pixel];
    uint32_t nearer = 0, farther = 0;
    wide k0 = wide_all((float)key), kx = wide_all((float)t->key_x), ky = wide_all((float)t->key_y), room = wide_all(own + error);
    for (int i = 0; i < 32; i += WIDTH) {
        wide value = wide_add(wide_add(k0, wide_mul(kx, wide_load(s->x + i))), wide_mul(ky, wide_load(s->y + i)));
        wide over = wide_sub(value, wide_load(s->key[pixel] + i));
        unsigned above = wide_above(over, room);
        nearer |= above << i;
        farther |= wide_above(wide_sub(wide_all(0), room), over) << i;
        unsigned take = plain ? above & sure.inside >> i : 0;
        wide_put(contest.keys + i, value, ~0u);
        wide_put(s->key[pixel] + i, value, take & ((1ull << WIDTH) - 1));
        wide_put_id(s->id[pixel] + i, t->id, take & ((1ull << WIDTH) - 1));
    }
    if (plain && (nearer & sure.inside)) {
        s->key_error[pixel] = error;
        update_farthest(s, pixel);
    }
    contest.crossed = sure.inside;
    contest.won = between ? sure.inside & nearer : 0;
    contest.error = error;
    uint32_t slowly = (unsure & ~farther) | (sure.inside & ~farther & (plain ? ~nearer : ~0u));
    if (t->holes && contest.won)
        slowly = (slowly & ~contest.won) | show_solid(s, job, t, pixel, &p, &contest);
    if (!slowly)
        return;
    show_slowly(s, job, t, pixel, x, y, slowly, &contest);
}

/* Pixels [from, to) of `length` that [low, high] in picture positions meets. */
static inline void pixel_span(float low, float high, uint32_t begin, uint32_t length, uint32_t *from, uint32_t *to)
{
    low -= BIN_MARGIN * (1 + fabsf(low));
    high += BIN_MARGIN * (1 + fabsf(high));
    *from = low > (float)begin ? low < (float)(begin + length) ? (uint32_t)low - begin : length : 0;
    *to = high < (float)(begin + length) ? high > (float)begin ? (uint32_t)high - begin + 1 : 0 : length;
}

/* Lines that bound a triangle from outside, over a tile's pixels: c + x vx + y vy < 0 where the pixel at (x, y) certainly is out. */
struct outline {
    float c[3], vx[3], vy[3];
};

static inline void outline_make(struct outline *o, const struct shown *t, double x0, double y0)
{
    for (int k = 0; k < 3; k++) {
        double vx = t->vx[k], vy = t->vy[k], rise = (vx > 0 ? vx : 0) + (vy > 0 ? vy : 0);
        double c = t->v[k] + x0 * vx + y0 * vy + rise;
        /* At most 2^-22 of this is rounding, of the coefficients to single precision and of two products and sums. */
        double room = 0x1p-19 * (fabs(c) + TILE_SIDE * (fabs(vx) + fabs(vy)));
        o->c[k] = t->certain ? (float)(c + room + t->error[k] + SINGLE_UNDERFLOW) : 1;
        o->vx[k] = t->certain ? (float)vx : 0;
        o->vy[k] = t->certain ? (float)vy : 0;
    }
}

/* Bit a pixel of a tile's row: the triangle may have samples there. */
static inline uint32_t row_met(const struct tile_scratch *s, const struct outline *o, float nearest, uint32_t y)
{
    uint32_t out = 0;
    for (int i = 0; i < TILE_SIDE; i += WIDTH) {
        wide x = wide_load(s->column + i);
        unsigned apart = wide_above(wide_load(s->farthest + y * TILE_SIDE + i), wide_all(nearest));
        for (int k = 0; k < 3; k++)
            apart |= wide_above(wide_all(-(o->c[k] + (float)y * o->vy[k])), wide_mul(x, wide_all(o->vx[k])));
        out |= apart << i;
    }
    return ~out;
}

static inline void show(struct tile_scratch *s, const struct tile_job *job, const struct bin_entry *entry, uint32_t x0,
                        uint32_t y0, uint32_t width, uint32_t height)
{
    const uint32_t id = entry->id, *corners = job->triangles->corners[id];
    const float *a = job->bins->corners[corners[0]], *b = job->bins->corners[corners[1]], *c = job->bins->corners[corners[2]];
    uint32_t left = 0, right = width, top = 0, bottom = height;
    struct shown shown;
    struct outline outline;
    if (!isnan(a[0] + b[0] + c[0])) {
        pixel_span(box_min(box_min(a[0], b[0]), c[0]), box_max(box_max(a[0], b[0]), c[0]), x0, width, &left, &right);
        pixel_span(box_min(box_min(a[1], b[1]), c[1]), box_max(box_max(a[1], b[1]), c[1]), y0, height, &top, &bottom);
    }
    if (left >= right || top >= bottom || !shown_make(&shown, job, &s->shown_mask, id))
        return;
    outline_make(&outline, &shown, x0, y0);
    const uint32_t span = (1u << right) - (1u << left);
    for (uint32_t y = top; y < bottom; y++)
        for (uint32_t bits = row_met(s, &outline, entry->nearest, y) & span; bits; bits &= bits - 1) {
            uint32_t x = (uint32_t)__builtin_ctz(bits);
            show_in_pixel(s, job, &shown, y * TILE_SIDE + x, x0 + x, y0 + y);
        }
}

enum { DEPTH_BUCKETS = 32 };

static inline uint32_t depth_bucket(float nearest, float most, float scale)
{
    float x = (most - nearest) * scale;
    return x > 0 ? x < DEPTH_BUCKETS - 1 ? (uint32_t)x : DEPTH_BUCKETS - 1 : 0;
}

/* The tile's entries, roughly from near to far, in s->order; `ends`: of the buckets. */
static inline void order_entries(struct tile_scratch *s, const struct bin_entry *entries, uint32_t count,
                                 uint32_t ends[DEPTH_BUCKETS])
{
    float most = -INFINITY, least = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        float key = entries[i].nearest;
        most = key < INFINITY ? box_max(most, key) : most;
        least = box_min(least, key);
    }
    const float scale = most > least ? DEPTH_BUCKETS / (most - least) : 0;
    memset(ends, 0, DEPTH_BUCKETS * sizeof *ends);
    for (uint32_t i = 0; i < count; i++)
        ends[depth_bucket(entries[i].nearest, most, scale)]++;
    for (uint32_t i = 0, sum = 0; i < DEPTH_BUCKETS; i++) {
        uint32_t own = ends[i];
        ends[i] = sum;
        sum += own;
    }
    for (uint32_t i = 0; i < count; i++)
        s->order[ends[depth_bucket(entries[i].nearest, most, scale)]++] = entries[i];
}

static inline float tile_farthest(const struct tile_scratch *s)
{
    wide least = wide_load(s->farthest);
    for (int i = WIDTH; i < TILE_PIXELS; i += WIDTH)
        least = wide_min(least, wide_load(s->farthest + i));
    return wide_least(least);
}

/* All triangles of a tile. */
static inline void show_all(struct tile_scratch *s, const struct tile_job *job, const struct bin_entry *entries, uint32_t count,
                            uint32_t x0, uint32_t y0, uint32_t width, uint32_t height)
{
    uint32_t ends[DEPTH_BUCKETS];
    order_entries(s, entries, count, ends);
    for (uint32_t bucket = 0, i = 0; bucket < DEPTH_BUCKETS; bucket++) {
        if (i == ends[bucket])
            continue;
        float farthest = tile_farthest(s);
        for (; i < ends[bucket]; i++)
            if (!(s->order[i].nearest < farthest))
                show(s, job, &s->order[i], x0, y0, width, height);
    }
}
