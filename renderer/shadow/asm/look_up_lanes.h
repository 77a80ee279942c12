/* Eight pixels' places in the trees, the pages there, and what these say. Included by the kernels only (look_up_plain.c, look_up_avx2.c). Names
 * and formulas are those of shaders/asm.glsl. */
#pragma once

#include "shadow/asm/look_up.h"
#include "shadow/depth/depth_receivers.h"

enum { FINEST = 2 * ASM_LEVELS, CELLS = ASM_CELLS * ASM_CELLS, TEXELS = ASM_PAGE * ASM_PAGE };
_Static_assert(ASM_CELLS == 4 && ASM_PAGE == 16, "shifts by 2 and 4");
#define TANGENT_MAX 8.0f

struct places {
    lane_ints on;   /* some map holds the point */
    lane_ints x, y; /* in finest texels; 0 where none does, as the rest */
    lane_ints root; /* its first slot */
    lanes depth;    /* along the map's axis */
    lanes w;        /* 1 or the depth: scales a texel */
    lanes near, far;
};

/* Along one axis of map i; `row` 0: x, 1: y. */
LANES_INLINE lane_ints place_along(const struct asm_job *job, unsigned i, unsigned row, const struct vector_lanes *point, lanes w)
{
    const float *r = job->block.asm_rows[3 * i + row];
    lanes limit = lanes_all(536870912.0f), offset = lanes_max(lanes_min((lanes_along(r, point) + r[3]) / w, limit), -limit);
    return job->block.asm_base[i][row] + lanes_truncate(lanes_floor(offset + job->block.asm_part[i][row]));
}

LANES_INLINE void place_in(const struct asm_job *job, unsigned i, const struct vector_lanes *point, lane_ints open,
                           struct places *p)
{
    const float *r = job->block.asm_rows[3 * i + 2], *part = job->block.asm_part[i];
    const int *base = job->block.asm_base[i];
    lanes depth = lanes_along(r, point) + r[3], w = job->depth.orthographic ? lanes_all(1) : depth;
    lane_ints x = place_along(job, i, 0, point, w), y = place_along(job, i, 1, point, w);
    /* The side is a power of two. */
    lane_ints in = open & (w > 0) & (((x | y) & -job->block.asm_counts[0]) == 0);
    p->on |= in;
    p->x |= x & in;
    p->y |= y & in;
    p->root |= in & lane_ints_all(base[3] * ASM_COLUMNS + base[2]);
    p->depth = lanes_pick(in, depth, p->depth);
    p->w = lanes_pick(in, w, p->w);
    p->near = lanes_pick(in, lanes_all(part[2]), p->near);
    p->far = lanes_pick(in, lanes_all(part[3]), p->far);
}

/* The first map that holds a receiver answers for it. */
LANES_INLINE void find_places(const struct asm_job *job, const struct receivers *r, struct places *p)
{
    p->on = p->x = p->y = p->root = lane_ints_all(0);
    p->depth = p->w = p->near = p->far = lanes_all(0);
    for (unsigned i = 0; i < job->depth.map_count; i++) {
        lane_ints open = r->receives & ~p->on;
        if (!lanes_bits(open))
            break;
        place_in(job, i, &r->point, open, p);
    }
}

struct leaves {
    lane_ints slot;
    lane_ints cell; /* of all slots', holding the place */
    lane_ints level;
    lane_ints texel; /* of all slots' */
};

/* The four bits of x and y that `shift` leaves, as a cell or a texel. */
LANES_INLINE lane_ints cell_within(lane_ints x, lane_ints y, int shift) { return ((y >> shift) & 3) << 2 | ((x >> shift) & 3); }
LANES_INLINE lane_ints texel_within(lane_ints x, lane_ints y, int shift)
{
    return ((y >> shift) & 15) << 4 | ((x >> shift) & 15);
}

/* The finest pages that hold the places (x, y), of those at most `limit` levels deep. All go down together; who has no page below stays. */
LANES_INLINE struct leaves find_leaves(const struct asm_job *job, const struct places *p, lane_ints x, lane_ints y,
                                       lane_ints limit)
{
    struct leaves leaf;
    int shift = FINEST + 2;
    leaf.slot = p->root + (y >> (FINEST + 4)) * ASM_COLUMNS + (x >> (FINEST + 4));
    leaf.cell = leaf.slot * CELLS + cell_within(x, y, shift);
    leaf.texel = leaf.slot * TEXELS + texel_within(x, y, shift - 2);
    leaf.level = lane_ints_all(0);
    for (int level = 0; level < ASM_LEVELS; level++) {
        lane_ints child = lane_ints_gather(job->cells, leaf.cell) & (limit > level), goes = child != 0;
        if (!lanes_bits(goes))
            break;
        shift -= 2;
        leaf.slot = lane_ints_pick(goes, child, leaf.slot);
        leaf.cell = lane_ints_pick(goes, child * CELLS + cell_within(x, y, shift), leaf.cell);
        leaf.texel = lane_ints_pick(goes, child * TEXELS + texel_within(x, y, shift - 2), leaf.texel);
        leaf.level -= goes;
    }
    return leaf;
}

/* 2^exponent, which is small. */
LANES_INLINE lanes power_of_two(lane_ints exponent) { return (lanes)((exponent + 127) << 23); }

LANES_INLINE lanes bias_of(const struct asm_job *job, const struct places *p, lane_ints level, lanes tangent, float slope)
{
    return job->depth.bias +
           slope * (job->block.asm_texel[0] * p->w) * power_of_two(-2 * level) * lanes_min(tangent, lanes_all(TANGENT_MAX));
}

/* Do the leaves see something before the points? */
LANES_INLINE lane_ints leaves_before(const struct asm_job *job, const struct places *p, const struct leaves *leaf, lanes tangent,
                                     float slope)
{
    lanes stored = lanes_gather(job->depths, leaf->texel), depth = p->depth - bias_of(job, p, leaf->level, tangent, slope);
    return texel_blocks(&job->depth, stored, depth, p->near, p->far - p->near, p->far);
}

/* Do they see other triangles than the points' own? */
LANES_INLINE lane_ints leaves_differ(const struct asm_job *job, const struct leaves *leaf, lane_ints ids)
{
    return lane_ints_gather(job->page_ids, leaf->texel) != ids;
}

/* The triangles of eight pixels `step` apart, the first at x; any for those beyond the picture. */
LANES_INLINE lane_ints ids_at(const struct asm_job *job, uint32_t x, uint32_t y, uint32_t step)
{
    lane_ints ids;
    const uint32_t *row = job->ids + (size_t)y * job->depth.width;
    for (uint32_t i = 0; i < LANES; i++)
        ids[i] = (int32_t)row[lesser(x + i * step, job->depth.width - 1)];
    return ids;
}

/* By depth, then by triangle: Fernando et al. 2001, section "combining ID and depth". */
LANES_INLINE lanes resolve_pixels(const struct asm_job *job, uint32_t x, uint32_t y)
{
    struct pixel room[LANES];
    struct receivers r;
    if (!receivers_at(&job->depth, pixels_at(&job->depth, x, y, room), x, y, &r))
        return lanes_all(0);
    struct places p;
    find_places(job, &r, &p);
    if (!lanes_bits(p.on))
        return lanes_if(r.receives, lanes_all(1));
    struct leaves leaf = find_leaves(job, &p, p.x, p.y, lane_ints_all(ASM_LEVELS));
    lane_ints dark = p.on & leaves_before(job, &p, &leaf, tangent_of(&r), job->depth.slope);
    if (lanes_bits(dark))
        dark &= leaves_differ(job, &leaf, ids_at(job, x, y, 1));
    return lanes_if(r.receives & ~dark, lanes_all(1));
}

static void resolve_rows(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct asm_job *job = context;
    const struct depth_job *d = &job->depth;
    uint32_t top = d->top + (uint32_t)index * DEPTH_ROWS, bottom = lesser(top + DEPTH_ROWS, d->bottom);
    for (uint32_t left = 0; left < d->width; left += DEPTH_COLUMNS)
        for (uint32_t y = top, right = lesser(left + DEPTH_COLUMNS, d->width); y < bottom; y++)
            for (uint32_t x = left; x < right; x += LANES)
                put_values(d->visibility + (size_t)y * d->width + x, resolve_pixels(job, x, y), d->width - x);
}
