/* soft's passes, eight pixels at once. Included by the kernels only (depth_plain.c, depth_avx*.c). */
#pragma once

#include "shadow/depth/bound_receivers.h"
#include "shadow/depth/soft_pass.h"

enum { SOFT_SEARCH = 4, SOFT_TAPS = 6, SOFT_TERM_BITS = 1023 };
static const float SOFT_WIDTH = 2.5f, SOFT_BEND = 0.25f, SOFT_FLAT_PIXELS = 2;

/* The packing of shaders/soft_term.glsl. */
LANES_INLINE lane_ints term_pack(lanes term, lanes guide)
{
    return ((lane_ints)guide & ~SOFT_TERM_BITS) | lanes_truncate(term * (float)SOFT_TERM_BITS + 0.5f);
}
LANES_INLINE lanes term_value(lane_ints term) { return lanes_from(term & SOFT_TERM_BITS) * (1.0f / SOFT_TERM_BITS); }
LANES_INLINE lanes term_guide(lane_ints term) { return (lanes)(term & ~SOFT_TERM_BITS); }

/* Eight receivers on their maps, with what the search needs. */
struct soft_points {
    const struct soft_job *job;
    const struct map_points *m;
    lanes own;              /* what the receiver would store, bias taken off */
    lanes slope_x, slope_y; /* of that, a texel, over the receiver's plane */
};

LANES_INLINE lanes depth_of(const struct soft_points *p, lanes stored)
{
    return p->job->depth.orthographic ? p->m->far - stored * p->m->range : p->m->near / stored;
}

LANES_INLINE lanes blur_radius(const struct soft_points *p, lanes depth)
{
    lanes away = (p->m->depth - depth) / (p->job->depth.orthographic ? p->m->range : depth);
    return p->job->settings.radius * lanes_min(lanes_max(away, lanes_all(0)), lanes_all(p->job->settings.far));
}

LANES_INLINE lanes own_stored(const struct depth_job *job, const struct receivers *r, const struct map_points *m)
{
    lanes depth = biased_depth(job, r, m);
    return job->orthographic ? lanes_max((m->far - depth) / m->range, lanes_all(0)) : m->near / depth;
}

/* Both encodings are affine over a plane's picture. */
LANES_INLINE void plane_slopes(struct soft_points *p, const struct receivers *r)
{
    const struct depth_job *job = &p->job->depth;
    const struct map_points *m = p->m;
    p->slope_x = p->slope_y = lanes_all(0);
    for (unsigned i = 0; i < job->map_count; i++) {
        const struct depth_map *map = &job->maps[i];
        lane_ints here = m->on & (m->map == (int32_t)i);
        if (!lanes_bits(here))
            continue;
        lanes nx = lanes_along(map->row[0], &r->normal), ny = lanes_along(map->row[1], &r->normal),
              nz = lanes_along(map->row[2], &r->normal), scale;
        if (job->orthographic)
            scale = 1 / (nz * m->range);
        else
            scale =
                m->near /
                (m->depth * (nx * ((m->x - map->offset_x) / map->scale_x) + ny * ((m->y - map->offset_y) / map->scale_y) + nz));
        p->slope_x = lanes_pick(here, scale * nx / map->scale_x, p->slope_x);
        p->slope_y = lanes_pick(here, scale * ny / map->scale_y, p->slope_y);
    }
}

LANES_INLINE lane_ints clamped(lane_ints a, int32_t last)
{
    return lane_ints_min(lane_ints_max(a, lane_ints_all(0)), lane_ints_all(last));
}

/* Occluders found so far. */
struct found {
    lanes sum; /* of what they store */
    lane_ints count;
};

/* A column or a row of texels: its share of their indices, and of what the receiver's plane stores there. */
struct tap_line {
    lane_ints at;
    lanes plane;
};

LANES_INLINE struct tap_line tap_column(const struct soft_points *p, lanes x)
{
    return (struct tap_line){clamped(lanes_truncate(x), p->job->depth.side - 1), p->own + p->slope_x * (x + 0.5f - p->m->x)};
}

LANES_INLINE struct tap_line tap_row(const struct soft_points *p, lanes y)
{
    const int32_t side = p->job->depth.side;
    return (struct tap_line){(p->m->map * side + clamped(lanes_truncate(y), side - 1)) * side, p->slope_y * (y + 0.5f - p->m->y)};
}

LANES_INLINE lane_ints tap(const struct soft_points *p, const struct tap_line *x, const struct tap_line *y, lane_ints wanted,
                           struct found *f)
{
    lanes stored = lanes_gather(p->job->depth.texels, y->at + x->at);
    lane_ints hit = wanted & (stored > lanes_max(x->plane + y->plane, lanes_all(0)));
    f->sum += lanes_if(hit, stored);
    f->count -= hit;
    return hit;
}

/* Four texels, interpolated: the term's own edge is one texel wide. */
LANES_INLINE lanes darkness(const struct soft_points *p, lane_ints wanted, struct found *f)
{
    lanes x = lanes_floor(p->m->x - 0.5f), y = lanes_floor(p->m->y - 0.5f), one = lanes_all(1);
    lanes u = p->m->x - 0.5f - x, v = p->m->y - 0.5f - y;
    const struct tap_line left = tap_column(p, x), right = tap_column(p, x + 1), top = tap_row(p, y), bottom = tap_row(p, y + 1);
    lanes a = lanes_if(tap(p, &left, &top, wanted, f), one), b = lanes_if(tap(p, &right, &top, wanted, f), one);
    lanes c = lanes_if(tap(p, &left, &bottom, wanted, f), one), d = lanes_if(tap(p, &right, &bottom, wanted, f), one);
    return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
}

LANES_INLINE void search(const struct soft_points *p, lane_ints wanted, lanes reach, struct found *f)
{
    struct tap_line column[SOFT_SEARCH], row[SOFT_SEARCH];
    for (int i = 0; i < SOFT_SEARCH; i++) {
        lanes off = ((float)i * (2.0f / (SOFT_SEARCH - 1)) - 1) * reach;
        column[i] = tap_column(p, lanes_floor(p->m->x + off));
        row[i] = tap_row(p, lanes_floor(p->m->y + off));
    }
    for (int j = 0; j < SOFT_SEARCH; j++)
        for (int i = 0; i < SOFT_SEARCH; i++)
            tap(p, &column[i], &row[j], wanted, f);
}

/* Length across the light of a pixel's step `dx` over the receiver. */
LANES_INLINE lanes step_length(const struct soft_job *job, const struct receivers *r, int axis)
{
    const struct pixel_rays *rays = &job->depth.rays;
    const float *d = axis == 0 ? (job->parallel ? rays->origin_dx : rays->direction_dx)
                               : (job->parallel ? rays->origin_dy : rays->direction_dy);
    lanes scale = job->parallel ? lanes_all(1) : r->depth;
    struct vector_lanes s = {scale * d[0], scale * d[1], scale * d[2]};
    lanes along = lanes_dot(&r->normal, &s) / lanes_dot(&r->normal, &r->direction);
    s.x -= r->direction.x * along;
    s.y -= r->direction.y * along;
    s.z -= r->direction.z * along;
    along = lanes_dot(&s, &r->v) / r->d2;
    s.x -= r->v.x * along;
    s.y -= r->v.y * along;
    s.z -= r->v.z * along;
    return lanes_sqrt(lanes_dot(&s, &s));
}

/* How far off, in texels, something may lie that shades a receiver: by the nearest that is stored round it. */
LANES_INLINE lanes search_reach(const struct soft_points *p)
{
    const struct map_bounds *b = p->job->depth.bounds;
    const struct bound_level *level = &b->levels[b->nearest_level];
    float side = (float)(BOUND_SIDE << b->nearest_level);
    lane_ints blocks = lane_ints_all((int32_t)level->blocks);
    lane_ints at = (p->m->map * blocks + lanes_truncate(p->m->y / side)) * blocks + lanes_truncate(p->m->x / side);
    lanes nearest = lanes_gather(b->nearest, at);
    return lanes_if(p->m->on & (nearest > 0), lanes_min(blur_radius(p, depth_of(p, nearest)) / p->m->texel, lanes_all(side)));
}

/* Whether all of `reach` lies behind the receiver's plane, or all of it before. */
LANES_INLINE void rule_out(const struct soft_points *p, lanes reach, lane_ints *lit, lane_ints *dark)
{
    const struct receiver_bounds b = bounds_at(&p->job->depth, p->m, reach);
    lanes around = reach + 1;
    lanes spread = around * (lanes_abs(b.slope_x - p->slope_x) + lanes_abs(b.slope_y - p->slope_y)) + BOUND_MARGIN;
    *lit = b.high + spread <= p->own;
    *dark = (b.low - spread > p->own) & (b.low > around * (lanes_abs(b.slope_x) + lanes_abs(b.slope_y)) + BOUND_MARGIN);
}

/* Sets the standard deviations where there is a blur, and returns the term. */
LANES_INLINE lanes soft_term(const struct soft_job *job, const struct receivers *r, const struct map_points *m, lanes sigma[2])
{
    struct soft_points p = {.job = job, .m = m, .own = own_stored(&job->depth, r, m)};
    struct found found = {lanes_all(0), lane_ints_all(0)};
    lane_ints all_lit, all_dark;
    plane_slopes(&p, r);
    lanes reach = search_reach(&p);
    rule_out(&p, reach, &all_lit, &all_dark);
    lane_ints reached = m->on & ~all_lit, wanted = reached & ~all_dark;
    if (!lanes_bits(reached))
        return lanes_all(1);
    lanes dark = darkness(&p, reached, &found);
    /* Nearer, there are only the four. */
    lane_ints seek = wanted & (reach > 0.5f);
    if (lanes_bits(seek))
        search(&p, seek, reach, &found);
    lane_ints any = found.count > 0;
    lanes across = lanes_if(any, blur_radius(&p, depth_of(&p, found.sum / lanes_from(found.count))));
    wanted &= any;
    if (lanes_bits(wanted))
        for (int axis = 0; axis < 2; axis++)
            sigma[axis] =
                lanes_if(wanted, lanes_min(lanes_max(0.5f * across / step_length(job, r, axis), lanes_all(job->settings.near)),
                                           lanes_all(1000)));
    float most = job->settings.radius * job->settings.far, scale = job->settings.lift / (most > 1e-30f ? most : 1e-30f);
    return 1 - dark * (1 - scale * across);
}

LANES_INLINE lane_ints soft_pixels(const struct soft_job *job, uint32_t x, uint32_t y, lanes sigma[2])
{
    struct pixel room[LANES];
    struct receivers r;
    sigma[0] = sigma[1] = lanes_all(0);
    if (!receivers_at(&job->depth, pixels_at(&job->depth, x, y, room), x, y, &r))
        return lane_ints_all(0);
    struct map_points m;
    place_receivers(&job->depth, &r, &m);
    lanes lit = lanes_all(1);
    if (lanes_bits(m.on))
        lit = lanes_pick(m.on, soft_term(job, &r, &m, sigma), lit);
    return term_pack(lit, job->parallel ? r.depth : 1 / r.depth) & r.receives;
}

/* Rows [top, bottom) at work, and their terms and deviations along x, rows of soft_pass.stride. */
struct soft_band {
    const struct soft_job *job;
    uint32_t top, bottom;
    uint32_t *terms;
    float *sigmas;
};

LANES_INLINE void put_term(const struct soft_band *b, uint32_t x, uint32_t y)
{
    const struct soft_pass *s = b->job->pass;
    size_t at = (size_t)(y - b->top) * s->stride + x, picture = (size_t)y * s->stride + x;
    lanes sigma[2];
    lane_ints_store(b->terms + at, soft_pixels(b->job, x, y, sigma));
    uint8_t blurs = lanes_bits((sigma[0] > 0) | (sigma[1] > 0)) != 0;
    s->blurs[picture / LANES] = blurs;
    if (!blurs)
        return;
    lanes_store(b->sigmas + at, sigma[0]);
    lanes_store(s->sigmas + picture, sigma[1]);
}

/* 2^x for x <= 0, within 2^-22 (2^-126 for less): Taylor's series around the nearest whole number. */
LANES_INLINE lanes exp2_lanes(lanes x)
{
    x = lanes_max(x, lanes_all(-126));
    lanes whole = lanes_floor(x + 0.5f), f = x - whole;
    lanes p =
        1 + f * (0.693147181f +
                 f * (0.240226507f + f * (0.0555041087f + f * (0.00961812911f + f * (0.00133335581f + f * 1.54035304e-4f)))));
    return p * (lanes)((lanes_truncate(whole) + 127) << 23);
}

/* Eight pixels' blur along one axis. */
struct blur {
    const struct soft_job *job;
    int axis;
    const uint32_t *from;       /* the first pixel's term; neighbours along the axis lie `pitch` apart */
    int32_t pitch, here;        /* here: the first pixel's place along the axis */
    int32_t first, end, length; /* places that have terms, and of all the picture */
    lanes sigma, guide;
    lanes slope;      /* of guide, a pixel along the axis over the receiver's plane */
    lanes grain;      /* a pixel's size in units of guide */
    lanes falloff;    /* of the Gaussian's exponent */
    lanes sum, total; /* of the taps so far */
};

static const lane_ints lane_steps = {0, 1, 2, 3, 4, 5, 6, 7};

LANES_INLINE lanes guide_slope(const struct blur *b, uint32_t x, uint32_t y)
{
    const struct depth_job *d = &b->job->depth;
    const struct pixel_rays *rays = &d->rays;
    struct pixel room[LANES];
    struct pixel_lanes p = pixel_lanes_load(pixels_at(d, x, y, room));
    struct vector_lanes n = pixel_lanes_geometric(p.geometric);
    struct vector_lanes ray = pixel_lanes_direction(rays, (float)x + lanes_from(lane_steps), (float)y);
    lanes n_d = lanes_dot(&n, &ray);
    if (b->job->parallel)
        return -lanes_along(b->axis == 0 ? rays->origin_dx : rays->origin_dy, &n) / n_d;
    return b->guide * lanes_along(b->axis == 0 ? rays->direction_dx : rays->direction_dy, &n) / n_d;
}

LANES_INLINE void blur_tap(struct blur *b, lane_ints term, lanes offset, lanes distance, lanes weight)
{
    lanes guide = term_guide(term), off_plane = lanes_abs(guide - b->guide - b->slope * offset);
    lane_ints counts = (off_plane <= b->grain * (SOFT_FLAT_PIXELS + SOFT_BEND * distance)) & (guide != 0);
    lanes w = lanes_if(counts, weight);
    b->sum += w * term_value(term);
    b->total += w;
}

/* Taps that lie alike for all eight, all within the picture: whole vectors. */
LANES_INLINE void blur_alike(struct blur *b, float stride, int side_taps)
{
    for (int i = 1; i <= side_taps; i++) {
        int32_t step = (int32_t)((float)i * stride + 0.5f);
        const uint32_t *from = b->from - step * b->pitch, *to = b->from + step * b->pitch;
        lanes offset = lanes_all((float)step), weight = exp2_lanes(b->falloff * offset * offset);
        blur_tap(b, lane_ints_load(from), -offset, offset, weight);
        blur_tap(b, lane_ints_load(to), offset, offset, weight);
    }
}

/* Each pixel's own taps. */
LANES_INLINE void blur_each(struct blur *b, lanes wide)
{
    lanes one = lanes_all(1), whole = lanes_from(lanes_truncate(wide));
    lanes side_taps = lanes_min(whole + lanes_if(whole < wide, one), lanes_all(SOFT_TAPS));
    lanes stride = lanes_max(wide / lanes_max(side_taps, one), one);
    lane_ints here = b->axis == 0 ? b->here + lane_steps : lane_ints_all(b->here);
    for (int i = 0; i < 2 * SOFT_TAPS; i++) {
        lane_ints active = side_taps > (float)(i / 2);
        if (!lanes_bits(active))
            break;
        lanes offset = lanes_floor((float)(i / 2 + 1) * stride + 0.5f) * (i % 2 ? -1.0f : 1.0f);
        lane_ints at = clamped(here + lanes_truncate(offset), b->length - 1);
        active &= (at >= b->first) & (at < b->end);
        lane_ints off = lane_ints_pick(active, at, here) - b->here;
        lane_ints term = lane_ints_gather(b->from, b->axis == 0 ? off : off * b->pitch + lane_steps);
        offset = lanes_from(at - here);
        blur_tap(b, term, offset, lanes_abs(offset), lanes_if(active, exp2_lanes(b->falloff * offset * offset)));
    }
}

LANES_INLINE lanes blurred(struct blur *b, lane_ints own, uint32_t x, uint32_t y)
{
    lanes value = term_value(own), wide = SOFT_WIDTH * b->sigma;
    b->guide = term_guide(own);
    b->slope = guide_slope(b, x, y);
    b->grain = b->job->grain * (b->job->parallel ? lanes_all(1) : b->guide);
    b->falloff = -0.72134752f / lanes_max(b->sigma * b->sigma, lanes_all(1e-6f));
    b->sum = value;
    b->total = lanes_all(1);
    float widest = lanes_largest(wide), narrowest = lanes_least(lanes_pick(wide > 0, wide, lanes_all(INFINITY)));
    int32_t reach = (int32_t)widest + 1, last = b->here + reach + (b->axis == 0 ? LANES - 1 : 0);
    bool alike = widest <= larger(SOFT_TAPS, 2 * narrowest);
    if (alike && b->here - reach >= b->first && last < b->end) {
        int side_taps = reach < SOFT_TAPS ? reach : SOFT_TAPS;
        blur_alike(b, larger(widest / (float)side_taps, 1), side_taps);
    } else {
        blur_each(b, wide);
    }
    return lanes_pick(b->sigma > 0, b->sum / b->total, value);
}

static inline void blur_band_x(const struct soft_band *band, uint32_t y)
{
    const struct soft_pass *s = band->job->pass;
    const struct depth_job *d = &band->job->depth;
    size_t first = (size_t)(y - band->top) * s->stride;
    const uint32_t *row = band->terms + first;
    struct blur b = {.job = band->job, .pitch = 1, .end = (int32_t)d->width, .length = (int32_t)d->width};
    for (uint32_t x = 0; x < d->width; x += LANES) {
        size_t at = (size_t)y * s->stride + x;
        lane_ints own = lane_ints_load(row + x);
        lanes lit = term_value(own);
        if (s->blurs[at / LANES]) {
            b.from = row + x;
            b.here = (int32_t)x;
            b.sigma = lanes_load(band->sigmas + first + x);
            lit = blurred(&b, own, x, y);
            own = term_pack(lit, term_guide(own));
        }
        lane_ints_store(s->terms + at, own);
        put_values(d->visibility + (size_t)y * d->width + x, lanes_if(term_guide(own) != 0, lit), d->width - x);
    }
}

/* A band of rows: their terms, blurred along x while they are near. */
static void soft_term_rows(void *context, size_t index, unsigned worker)
{
    const struct soft_job *job = context;
    const struct depth_job *d = &job->depth;
    uint32_t top = d->top + (uint32_t)index * DEPTH_ROWS;
    size_t room = DEPTH_ROWS * (size_t)job->pass->stride;
    const struct soft_band b = {job, top, lesser(top + DEPTH_ROWS, d->bottom), job->pass->band_terms + worker * room,
                                job->pass->band_sigmas + worker * room};
    for (uint32_t left = 0; left < d->width; left += DEPTH_COLUMNS)
        for (uint32_t y = b.top, right = lesser(left + DEPTH_COLUMNS, d->width); y < b.bottom; y++)
            for (uint32_t x = left; x < right; x += LANES)
                put_term(&b, x, y);
    for (uint32_t y = b.top; y < b.bottom; y++)
        blur_band_x(&b, y);
}

/* After all bands, along y. */
static void soft_blur_rows(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct soft_job *job = context;
    const struct depth_job *d = &job->depth;
    const struct soft_pass *s = job->pass;
    uint32_t top = d->top + (uint32_t)index * DEPTH_ROWS, bottom = lesser(top + DEPTH_ROWS, d->bottom);
    struct blur b = {.job = job,
                     .axis = 1,
                     .pitch = (int32_t)s->stride,
                     .first = (int32_t)d->top,
                     .end = (int32_t)d->bottom,
                     .length = (int32_t)d->height};
    for (uint32_t left = 0; left < d->width; left += DEPTH_COLUMNS)
        for (uint32_t y = top, right = lesser(left + DEPTH_COLUMNS, d->width); y < bottom; y++)
            for (uint32_t x = left; x < right; x += LANES) {
                size_t at = (size_t)y * s->stride + x;
                if (!s->blurs[at / LANES])
                    continue;
                lane_ints own = lane_ints_load(s->terms + at);
                b.from = s->terms + at;
                b.here = (int32_t)y;
                b.sigma = lanes_load(s->sigmas + at);
                lanes lit = blurred(&b, own, x, y);
                put_values(d->visibility + (size_t)y * d->width + x, lanes_if(term_guide(own) != 0, lit), d->width - x);
            }
}
