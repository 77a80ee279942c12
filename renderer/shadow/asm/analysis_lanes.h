/* The analysis of shaders/asm_analysis.comp, eight pixels at a time. Included by the kernels only (look_up_plain.c, look_up_avx2.c). Counters only
 * grow by additions, so their sums do not depend on the order of the threads. */
#pragma once

#include "shadow/asm/look_up_lanes.h"

/* Benefit of a finer page to a pixel: an edge that is seen comes before one that may be there. */
enum { EDGE = 4, DOUBT = 1 };

/* Pixels that are looked at, and what is asked of them. */
struct subjects {
    struct places p;
    lane_ints ids;
    lanes tangent, too_large; /* times by which a root texel's area exceeds what is wanted */
};

LANES_INLINE lane_ints subjects_dark(const struct asm_job *job, const struct subjects *s, const struct leaves *leaf, float slope)
{
    lane_ints dark = leaves_before(job, &s->p, leaf, s->tangent, slope);
    return lanes_bits(dark) ? dark & leaves_differ(job, leaf, s->ids) : dark;
}

/* Places beside theirs, in texels of a level. */
struct beside {
    lane_ints x, y;       /* of theirs */
    lane_ints to_x, to_y; /* the nearest neighbour along each axis, finest texels */
    lane_ints last;       /* place in a map */
    lane_ints level;
};

LANES_INLINE struct leaves leaves_beside(const struct asm_job *job, const struct subjects *s, const struct beside *b, int i,
                                         int j)
{
    lane_ints none = lane_ints_all(0);
    lane_ints x = lane_ints_min(lane_ints_max(b->x + i * b->to_x, none), b->last);
    lane_ints y = lane_ints_min(lane_ints_max(b->y + j * b->to_y, none), b->last);
    return find_leaves(job, &s->p, x, y, b->level);
}

/* Do the four texels whose centres are around the place not all agree? Three of them lie up to one and a half texels away, along the receiver's
 * plane: so their slope. */
LANES_INLINE lane_ints is_ambiguous(const struct asm_job *job, const struct subjects *s, const struct beside *b, lane_ints asked)
{
    float slope = job->depth.slope;
    struct leaves own = leaves_beside(job, s, b, 0, 0);
    lane_ints dark = subjects_dark(job, s, &own, slope), other = lane_ints_all(0);
    for (int i = 1; i < 4 && lanes_bits(asked & ~other); i++) {
        struct leaves leaf = leaves_beside(job, s, b, i & 1, i >> 1);
        other |= subjects_dark(job, s, &leaf, slope + 1) ^ dark;
    }
    return other & asked;
}

/* What leaves say of the points, added up. In doubt: it hangs on the bias, lit only for it or dark by less than as much again. */
struct answers {
    lane_ints lit, dark, doubt;
};

LANES_INLINE void add_answers(const struct asm_job *job, const struct subjects *s, const struct leaves *leaf, struct answers *a)
{
    const struct places *p = &s->p;
    lanes stored = lanes_gather(job->depths, leaf->texel);
    lanes seen_at =
        job->depth.orthographic ? p->far - stored * (p->far - p->near) : p->near / lanes_max(stored, lanes_all(1e-37f));
    lanes behind = p->depth - seen_at;
    lane_ints lit = (stored == 0) | (behind <= 0);
    if (lanes_bits(~lit))
        lit |= ~leaves_differ(job, leaf, s->ids);
    lane_ints close = behind <= 2 * bias_of(job, p, leaf->level, s->tangent, job->depth.slope);
    a->lit |= lit;
    a->doubt |= ~lit & close;
    a->dark |= ~lit & ~close;
}

/* EDGE, DOUBT or 0 of texels larger than a pixel. What is smaller than they are may lie between them; their bias is large, so all may agree on an
 * answer that is wrong: at the foot of things, in folds. So all next to the place's own count, and doubt is enough. */
LANES_INLINE lane_ints edge_or_doubt(const struct asm_job *job, const struct subjects *s, const struct beside *b, lane_ints asked)
{
    struct answers a = {0};
    for (int i = 0; i < 9 && lanes_bits(asked & ~(a.lit & a.dark)); i++) {
        struct leaves leaf = leaves_beside(job, s, b, i % 3 - 1, i / 3 - 1);
        add_answers(job, s, &leaf, &a);
    }
    return asked & lane_ints_pick(a.lit & a.dark, lane_ints_all(EDGE), a.doubt & DOUBT);
}

/* What texels finer than those of `level` would be to the pixels `asked`. */
LANES_INLINE lane_ints wants_finer(const struct asm_job *job, const struct subjects *s, lane_ints level, lane_ints asked)
{
    lanes rest = s->too_large * power_of_two(-4 * level);
    lane_ints large = asked & (rest > job->detail * job->detail), small = asked & ~large & (rest > 1);
    if (!lanes_bits(large | small))
        return lane_ints_all(0);
    lane_ints texel = lane_ints_all(1) << (FINEST - 2 * level), half_bit = lane_ints_max(texel >> 1, lane_ints_all(1));
    struct beside b = {.x = s->p.x,
                       .y = s->p.y,
                       .to_x = lane_ints_pick((s->p.x & half_bit) != 0, texel, -texel),
                       .to_y = lane_ints_pick((s->p.y & half_bit) != 0, texel, -texel),
                       .last = lane_ints_all(job->block.asm_counts[0] - 1),
                       .level = level};
    lane_ints benefit = lane_ints_all(0);
    if (lanes_bits(large))
        benefit = edge_or_doubt(job, s, &b, large);
    if (lanes_bits(small))
        benefit |= is_ambiguous(job, s, &b, small) & EDGE;
    return benefit;
}

/* A pixel's footprint on the surface, seen from the light, over detail^2, is what a texel's area is wanted to be. */
LANES_INLINE lanes excess(const struct asm_job *job, const struct places *p, const struct receivers *r)
{
    lanes one = lanes_all(1), least = lanes_all(0.1f), distance = lanes_sqrt(r->d2), length = lanes_sqrt(r->n2);
    lanes side = job->grain * (job->parallel ? one : r->depth), cosine = r->n_v / (length * distance);
    lanes to_axis = job->depth.orthographic ? one : p->w / lanes_max(distance, lanes_all(1e-30f));
    lanes facing = lanes_abs(lanes_dot(&r->normal, &r->direction)) / length;
    lanes area = side * side / lanes_max(facing, least) * lanes_max(cosine, least) / lanes_max(to_axis, least);
    lanes texel = job->block.asm_texel[0] * job->block.asm_texel[1] * p->w * p->w;
    return texel * job->detail * job->detail / lanes_max(area, lanes_all(1e-37f));
}

/* The pixels that have their turn, the first at x; those beyond the picture have no surface. */
LANES_INLINE void pick_pixels(const struct asm_job *job, uint32_t x, uint32_t y, struct pixel out[LANES])
{
    uint32_t every = (uint32_t)job->block.asm_counts[2];
    for (uint32_t i = 0; i < LANES; i++, x += every)
        out[i] = x < job->depth.width ? job->depth.pixels[(size_t)y * job->depth.width + x] : (struct pixel){0};
}

/* Which of those at (x, y) are lit where those `dark` are not, or the other way round; receivers only. */
LANES_INLINE lane_ints differ(const struct asm_job *job, uint32_t x, uint32_t y, lane_ints dark, lane_ints asked)
{
    uint32_t every = (uint32_t)job->block.asm_counts[2];
    const struct depth_job *d = &job->depth;
    lane_ints lit;
    if (y >= d->bottom)
        return lane_ints_all(0);
    for (uint32_t i = 0; i < LANES; i++)
        lit[i] = d->visibility[(size_t)y * d->width + lesser(x + i * every, d->width - 1)] > 0 ? -1 : 0;
    lane_ints other = asked & ~(lit ^ dark);
    if (!lanes_bits(other))
        return other;
    struct pixel room[LANES];
    struct receivers r;
    pick_pixels(job, x, y, room);
    receivers_of(d, room, (float)x + (float)every * (lanes){0, 1, 2, 3, 4, 5, 6, 7}, y, &r);
    return other & r.receives;
}

LANES_INLINE void add(uint32_t *counters, lane_ints at, lane_ints amount)
{
    for (unsigned bits = lanes_bits(amount != 0); bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        __atomic_fetch_add(&counters[at[i]], (uint32_t)amount[i], __ATOMIC_RELAXED);
    }
}

LANES_INLINE void mark_used(uint32_t *used, lane_ints slot, lane_ints asked)
{
    for (unsigned bits = lanes_bits(asked); bits; bits &= bits - 1) {
        uint32_t *at = &used[slot[__builtin_ctz(bits)]];
        if (!__atomic_load_n(at, __ATOMIC_RELAXED))
            __atomic_store_n(at, 1, __ATOMIC_RELAXED);
    }
}

LANES_INLINE void analyse_pixels(const struct asm_job *job, uint32_t x, uint32_t y)
{
    uint32_t every = (uint32_t)job->block.asm_counts[2];
    struct pixel room[LANES];
    struct receivers r;
    struct subjects s;
    pick_pixels(job, x, y, room);
    if (!receivers_of(&job->depth, room, (float)x + (float)every * (lanes){0, 1, 2, 3, 4, 5, 6, 7}, y, &r))
        return;
    find_places(job, &r, &s.p);
    lane_ints asked = s.p.on;
    if (!lanes_bits(asked))
        return;
    s.ids = ids_at(job, x, y, every);
    s.tangent = tangent_of(&r);
    s.too_large = excess(job, &s.p, &r);
    struct leaves leaf = find_leaves(job, &s.p, s.p.x, s.p.y, lane_ints_all(ASM_LEVELS));
    mark_used(job->counters.used, leaf.slot, asked);
    add(job->counters.cells, leaf.cell, wants_finer(job, &s, leaf.level, asked & (leaf.level < ASM_LEVELS)));
    add(job->counters.worth, leaf.slot, wants_finer(job, &s, leaf.level - 1, asked & (leaf.level > 0)));
    lane_ints dark = subjects_dark(job, &s, &leaf, job->depth.slope);
    add(job->counters.levels, leaf.level, (differ(job, x + 1, y, dark, asked) | differ(job, x, y + 1, dark, asked)) & 1);
}

static void analyse_rows(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct asm_job *job = context;
    uint32_t every = (uint32_t)job->block.asm_counts[2], turn = (uint32_t)job->block.asm_counts[3];
    uint32_t top = job->depth.top + (uint32_t)index * DEPTH_ROWS, bottom = lesser(top + DEPTH_ROWS, job->depth.bottom);
    for (uint32_t y = top; y < bottom; y++)
        for (uint32_t x = (turn + 3 * y) % every; x < job->depth.width; x += every * LANES)
            analyse_pixels(job, x, y);
}
