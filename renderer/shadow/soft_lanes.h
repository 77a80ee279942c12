/* soft's passes, eight pixels at once. Included by the kernels only (depth_plain.c, depth_avx2.c). */
#pragma once

#include "shadow/depth_receivers.h"
#include "shadow/soft_pass.h"

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
    lanes sum, count; /* of what they store */
};

LANES_INLINE lanes look_at(const struct soft_points *p, lanes x, lanes y, lane_ints wanted, struct found *f)
{
    const struct depth_job *job = &p->job->depth;
    lane_ints at = texel_at(job, p->m, clamped(lanes_truncate(x), job->side - 1), clamped(lanes_truncate(y), job->side - 1));
    lanes stored = lanes_gather(job->texels, at);
    lanes plane = p->own + p->slope_x * (x + 0.5f - p->m->x) + p->slope_y * (y + 0.5f - p->m->y);
    lanes hit = lanes_if(wanted & (stored > lanes_max(plane, lanes_all(0))), lanes_all(1));
    f->sum += hit * stored;
    f->count += hit;
    return hit;
}

/* Four texels, interpolated: the term's own edge is one texel wide. */
LANES_INLINE lanes darkness(const struct soft_points *p, struct found *f)
{
    lanes x = lanes_floor(p->m->x - 0.5f), y = lanes_floor(p->m->y - 0.5f);
    lanes u = p->m->x - 0.5f - x, v = p->m->y - 0.5f - y;
    lanes a = look_at(p, x, y, p->m->on, f), b = look_at(p, x + 1, y, p->m->on, f);
    lanes c = look_at(p, x, y + 1, p->m->on, f), d = look_at(p, x + 1, y + 1, p->m->on, f);
    return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
}

LANES_INLINE void search(const struct soft_points *p, lane_ints wanted, lanes reach, struct found *f)
{
    for (int i = 0; i < SOFT_SEARCH * SOFT_SEARCH; i++) {
        float dx = (float)(i % SOFT_SEARCH) * (2.0f / (SOFT_SEARCH - 1)) - 1;
        float dy = (float)(i / SOFT_SEARCH) * (2.0f / (SOFT_SEARCH - 1)) - 1;
        look_at(p, lanes_floor(p->m->x + dx * reach), lanes_floor(p->m->y + dy * reach), wanted, f);
    }
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

/* Sets the standard deviations where there is a blur, and returns the term. */
LANES_INLINE lanes soft_term(const struct soft_job *job, const struct receivers *r, const struct map_points *m, lanes sigma[2])
{
    const struct soft_pass *s = job->pass;
    struct soft_points p = {.job = job, .m = m, .own = own_stored(&job->depth, r, m)};
    struct found found = {lanes_all(0), lanes_all(0)};
    int32_t blocks = (int32_t)s->blocks;
    lanes zero = lanes_all(0), block = lanes_all((float)s->block), near = lanes_all(job->settings.near);
    lane_ints at = (m->map * blocks + lanes_truncate(m->y / block)) * blocks + lanes_truncate(m->x / block);
    plane_slopes(&p, r);
    lanes nearest = lanes_gather(s->ranges, at * 2), farthest = lanes_gather(s->ranges + 1, at * 2);
    lanes spread = 2 * block * (lanes_abs(p.slope_x) + lanes_abs(p.slope_y));
    lane_ints reached = m->on & (nearest > lanes_max(p.own - spread, zero)), wanted = reached & (farthest <= p.own + spread);
    if (!lanes_bits(reached))
        return lanes_all(1);
    lanes dark = darkness(&p, &found);
    if (lanes_bits(wanted))
        search(&p, wanted, lanes_min(blur_radius(&p, depth_of(&p, nearest)) / m->texel, block), &found);
    lane_ints any = found.count > 0;
    lanes across = lanes_if(any, blur_radius(&p, depth_of(&p, found.sum / found.count)));
    wanted &= any;
    if (lanes_bits(wanted))
        for (int axis = 0; axis < 2; axis++)
            sigma[axis] =
                lanes_if(wanted, lanes_min(lanes_max(0.5f * across / step_length(job, r, axis), near), lanes_all(1000)));
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

LANES_INLINE void put_ints(uint32_t *out, lane_ints values, uint32_t count)
{
    if (count >= LANES)
        lane_ints_store(out, values);
    else
        for (uint32_t i = 0; i < count; i++)
            out[i] = (uint32_t)values[i];
}

LANES_INLINE void put_term(const struct soft_job *job, uint32_t x, uint32_t y)
{
    size_t at = (size_t)y * job->depth.width + x;
    uint32_t count = job->depth.width - x;
    lanes sigma[2];
    put_ints(job->pass->terms + at, soft_pixels(job, x, y, sigma), count);
    put_values(job->pass->sigmas[0] + at, sigma[0], count);
    put_values(job->pass->sigmas[1] + at, sigma[1], count);
}

static inline void clear_row(struct soft_pass *s, uint32_t y, uint32_t width)
{
    memset(s->terms + (size_t)y * width, 0, width * sizeof *s->terms);
    memset(s->blurred + (size_t)y * width, 0, width * sizeof *s->blurred);
}

/* All rows: taps reach into those without surfaces. */
static void soft_term_rows(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct soft_job *job = context;
    const struct depth_job *d = &job->depth;
    uint32_t top = (uint32_t)index * DEPTH_ROWS, bottom = lesser(top + DEPTH_ROWS, d->height);
    for (uint32_t y = top; y < bottom; y++)
        if (y < d->top || y >= d->bottom)
            clear_row(job->pass, y, d->width);
    top = top > d->top ? top : d->top;
    bottom = lesser(bottom, d->bottom);
    for (uint32_t left = 0; left < d->width; left += DEPTH_COLUMNS)
        for (uint32_t y = top, right = lesser(left + DEPTH_COLUMNS, d->width); y < bottom; y++)
            for (uint32_t x = left; x < right; x += LANES)
                put_term(job, x, y);
}

/* 2^x for x in [-126, 0], within 2^-22: Taylor's series around the nearest whole number. */
LANES_INLINE lanes exp2_lanes(lanes x)
{
    lanes whole = lanes_floor(lanes_max(x, lanes_all(-126)) + 0.5f), f = x - whole;
    lanes p =
        1 + f * (0.693147181f +
                 f * (0.240226507f + f * (0.0555041087f + f * (0.00961812911f + f * (0.00133335581f + f * 1.54035304e-4f)))));
    return p * (lanes)((lanes_truncate(whole) + 127) << 23);
}

struct blur {
    const struct soft_job *job;
    const uint32_t *from;
    int axis;
    lanes sigma, guide, slope; /* of guide, a pixel along the axis over the receiver's plane */
    lanes here;                /* along the axis */
    lane_ints row;             /* index of the pixel that `here` = 0 would be */
};

LANES_INLINE lanes guide_slope(const struct blur *b, uint32_t x, uint32_t y)
{
    const struct depth_job *d = &b->job->depth;
    const struct pixel_rays *rays = &d->rays;
    struct pixel room[LANES];
    struct pixel_lanes p = pixel_lanes_load(pixels_at(d, x, y, room));
    lanes fx = (float)x + (lanes){0, 1, 2, 3, 4, 5, 6, 7};
    struct vector_lanes n = pixel_lanes_geometric(p.geometric), ray = pixel_lanes_direction(rays, fx, (float)y);
    lanes n_d = lanes_dot(&n, &ray);
    if (b->job->parallel)
        return -lanes_along(b->axis == 0 ? rays->origin_dx : rays->origin_dy, &n) / n_d;
    return b->guide * lanes_along(b->axis == 0 ? rays->direction_dx : rays->direction_dy, &n) / n_d;
}

/* The Gaussian of eight pixels whose own terms are `own`. */
LANES_INLINE lanes blur_lanes(const struct blur *b, lanes own)
{
    const struct depth_job *d = &b->job->depth;
    lanes one = lanes_all(1), wide = SOFT_WIDTH * b->sigma, whole = lanes_from(lanes_truncate(wide));
    lanes side_taps = lanes_if(b->guide > 0, lanes_min(whole + lanes_if(whole < wide, one), lanes_all(SOFT_TAPS)));
    lanes stride = lanes_max(wide / lanes_max(side_taps, one), one);
    lanes falloff = -0.72134752f / lanes_max(b->sigma * b->sigma, lanes_all(1e-6f));
    lanes grain = b->job->grain * (b->job->parallel ? one : b->guide);
    lanes last = lanes_all((float)((b->axis == 0 ? d->width : d->height) - 1)), sum = own, total = one;
    int32_t step = b->axis == 0 ? 1 : (int32_t)d->width;
    for (int i = 0; i < 2 * SOFT_TAPS; i++) {
        lane_ints active = side_taps > (float)(i / 2);
        if (!lanes_bits(active))
            break;
        lanes offset = lanes_floor((float)(i / 2 + 1) * stride + 0.5f) * (i % 2 ? -1.0f : 1.0f);
        lanes at = lanes_min(lanes_max(b->here + offset, lanes_all(0)), last);
        lane_ints tap = lane_ints_gather(b->from, b->row + lanes_truncate(at) * step);
        lanes guide = term_guide(tap);
        offset = at - b->here;
        lanes off_plane = lanes_abs(guide - b->guide - b->slope * offset);
        lane_ints counts = active & (off_plane <= grain * (SOFT_FLAT_PIXELS + SOFT_BEND * lanes_abs(offset))) & (guide != 0);
        lanes w = lanes_if(counts, exp2_lanes(falloff * offset * offset));
        sum += w * term_value(tap);
        total += w;
    }
    return sum / total;
}

LANES_INLINE lanes blur_pixels(const struct soft_job *job, int axis, const uint32_t *from, uint32_t x, uint32_t y, lane_ints own)
{
    const struct depth_job *d = &job->depth;
    size_t at = (size_t)y * d->width + x;
    uint32_t count = d->width - x;
    lanes value = term_value(own), column = (float)x + (lanes){0, 1, 2, 3, 4, 5, 6, 7};
    struct blur b = {.job = job, .from = from, .axis = axis, .guide = term_guide(own)};
    if (count >= LANES) {
        b.sigma = lanes_load(job->pass->sigmas[axis] + at);
    } else {
        b.sigma = lanes_all(0);
        for (uint32_t i = 0; i < count; i++)
            b.sigma[i] = job->pass->sigmas[axis][at + i];
    }
    if (!lanes_bits(b.sigma > 0))
        return value;
    b.slope = guide_slope(&b, x, y);
    b.here = axis == 0 ? column : lanes_all((float)y);
    b.row = axis == 0 ? lane_ints_all((int32_t)(y * d->width))
                      : lane_ints_min(lanes_truncate(column), lane_ints_all((int32_t)d->width - 1));
    return lanes_pick(b.sigma > 0, blur_lanes(&b, value), value);
}

LANES_INLINE lane_ints own_terms(const uint32_t *from, uint32_t count)
{
    lane_ints own = lane_ints_all(0);
    if (count >= LANES)
        return lane_ints_load(from);
    for (uint32_t i = 0; i < count; i++)
        own[i] = (int32_t)from[i];
    return own;
}

LANES_INLINE void blur_rows(const struct soft_job *job, size_t index, int axis)
{
    const struct depth_job *d = &job->depth;
    const uint32_t *from = axis == 0 ? job->pass->terms : job->pass->blurred;
    uint32_t top = d->top + (uint32_t)index * DEPTH_ROWS, bottom = lesser(top + DEPTH_ROWS, d->bottom);
    for (uint32_t y = top; y < bottom; y++)
        for (uint32_t x = 0; x < d->width; x += LANES) {
            size_t at = (size_t)y * d->width + x;
            lane_ints own = own_terms(from + at, d->width - x);
            lanes lit = lanes_bits(own != 0) ? blur_pixels(job, axis, from, x, y, own) : lanes_all(0);
            if (axis == 0)
                put_ints(job->pass->blurred + at, term_pack(lit, term_guide(own)), d->width - x);
            else
                put_values(d->visibility + at, lanes_if(term_guide(own) != 0, lit), d->width - x);
        }
}

static void soft_blur_x_rows(void *context, size_t index, unsigned worker)
{
    (void)worker;
    blur_rows(context, index, 0);
}

static void soft_blur_y_rows(void *context, size_t index, unsigned worker)
{
    (void)worker;
    blur_rows(context, index, 1);
}
