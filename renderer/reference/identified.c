#include "reference/identified.h"

#include <stdlib.h>

#include "base/job_pool.h"
#include "trace/tracer.h"

enum { RAYS = IDENTIFIED_SIDE * IDENTIFIED_SIDE, CHUNK = 32, ROUND = 128 * CHUNK };

/* What became of one draw. */
struct drawn {
    uint16_t seen, found;
};

struct round {
    const struct tracer *tracer;
    const struct identified_input *in;
    uint64_t texel_count;
    unsigned bits; /* of the permuted numbers */
    uint64_t first, count;
    struct drawn *drawn; /* ROUND */
};

/* A permutation of the numbers below 2^bits: each step can be undone. */
static uint64_t permute(uint64_t x, unsigned bits)
{
    static const uint64_t odd[] = {0x9e3779b97f4a7c15, 0xbf58476d1ce4e5b9, 0x94d049bb133111eb};
    uint64_t mask = ((uint64_t)1 << bits) - 1;
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        x = (x * odd[i] + 0x1d872b41) & mask;
        x ^= x >> (bits / 2 + 1);
    }
    return x;
}

/* The map's view, cut down to one texel. */
static struct view texel_view(const struct identified_input *in, uint64_t texel)
{
    uint64_t per_map = (uint64_t)in->size * in->size;
    const struct view *map = &in->maps[texel / per_map];
    double column = (double)(texel % in->size), row = (double)(texel % per_map / in->size), size = in->size;
    double width = (map->right_edge - map->left) / size, height = (map->bottom - map->top) / size;
    struct view view = *map;
    view.width = view.height = IDENTIFIED_SIDE;
    view.left = map->left + column * width;
    view.right_edge = view.left + width;
    view.top = map->top + row * height;
    view.bottom = view.top + height;
    return view;
}

static int by_id(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Sorts `ids`, drops repeats and SCENE_NONE; returns how many are left. */
static unsigned distinct(uint32_t ids[RAYS])
{
    unsigned count = 0;
    qsort(ids, RAYS, sizeof *ids, by_id);
    for (unsigned i = 0; i < RAYS; i++)
        if (ids[i] != SCENE_NONE && (count == 0 || ids[count - 1] != ids[i]))
            ids[count++] = ids[i];
    return count;
}

static struct drawn measure_texel(const struct identified_input *in, uint64_t texel, uint32_t ids[RAYS])
{
    struct drawn d = {.seen = (uint16_t)distinct(ids)};
    for (uint32_t i = in->first[texel]; i < in->first[texel + 1]; i++)
        d.found += bsearch(&in->triangles[i], ids, d.seen, sizeof *ids, by_id) != NULL;
    return d;
}

static void measure_chunk(void *context, size_t index, unsigned worker)
{
    (void)worker;
    struct round *r = context;
    struct view views[CHUNK];
    uint64_t texels[CHUNK];
    uint32_t ids[CHUNK * RAYS];
    size_t at[CHUNK], count = 0;
    for (size_t i = index * CHUNK; i < (index + 1) * CHUNK && i < r->count; i++) {
        uint64_t texel = permute(r->first + i, r->bits);
        r->drawn[i] = (struct drawn){0};
        if (texel >= r->texel_count)
            continue;
        views[count] = texel_view(r->in, texel);
        texels[count] = texel;
        at[count++] = i;
    }
    if (count == 0)
        return;
    tracer_light_ids(r->tracer, views, count, r->in->casters, r->in->caster_count, NULL, ids);
    for (size_t i = 0; i < count; i++)
        r->drawn[at[i]] = measure_texel(r->in, texels[i], ids + i * RAYS);
}

static void add_texel(struct identified *sum, struct drawn d)
{
    unsigned by_oracle = d.seen < IDENTIFIED_ORACLE ? d.seen : IDENTIFIED_ORACLE;
    sum->texels++;
    sum->texels_over_4 += d.seen > 4;
    sum->seen += d.seen;
    sum->found += d.found;
    sum->found_by_oracle += by_oracle;
    sum->fractions += (double)d.found / d.seen;
    sum->oracle_fractions += (double)by_oracle / d.seen;
}

static bool report(const struct reference_progress *progress, const struct identified *sum, uint64_t drawn, uint64_t total)
{
    double texels = (double)sum->texels / IDENTIFIED_TEXELS, draws = (double)drawn / (double)total;
    return !progress || !progress->report || progress->report(progress->context, texels > draws ? texels : draws);
}

bool identified_measure(const struct tracer *tracer, const struct identified_input *in, struct job_pool *pool,
                        const struct reference_progress *progress, struct identified *out)
{
    struct round r = {.tracer = tracer, .in = in, .texel_count = (uint64_t)in->map_count * in->size * in->size};
    *out = (struct identified){0};
    while (((uint64_t)1 << r.bits) < r.texel_count)
        r.bits++;
    /* Numbers past the last texel are skipped; they are fewer than the texels. */
    uint64_t total = r.texel_count ? (uint64_t)1 << r.bits : 0, draws = 0;
    r.drawn = malloc(ROUND * sizeof *r.drawn);
    bool good = r.drawn != NULL;
    while (good && r.first < total && draws < IDENTIFIED_DRAWS && out->texels < IDENTIFIED_TEXELS) {
        r.count = total - r.first < ROUND ? total - r.first : ROUND;
        job_pool_for(pool, (r.count + CHUNK - 1) / CHUNK, measure_chunk, &r);
        for (uint64_t i = 0; i < r.count && out->texels < IDENTIFIED_TEXELS; i++)
            if (r.drawn[i].seen >= 2)
                add_texel(out, r.drawn[i]);
        r.first += r.count;
        draws += r.count;
        good = report(progress, out, draws, total < IDENTIFIED_DRAWS ? total : IDENTIFIED_DRAWS);
    }
    free(r.drawn);
    return good;
}

void identified_add(struct identified *sum, const struct identified *more)
{
    sum->texels += more->texels;
    sum->texels_over_4 += more->texels_over_4;
    sum->seen += more->seen;
    sum->found += more->found;
    sum->found_by_oracle += more->found_by_oracle;
    sum->fractions += more->fractions;
    sum->oracle_fractions += more->oracle_fractions;
}
