/* Sub-pixel coverage (Li, Yang, Han and Zhao 2017, "Coverage Detecting Algorithm Based on Sub-Pixel Geometric Primitives"): SPSM's map, and for each
 * texel a list of the triangles that neighbouring texels keep and that lie over this one too. docs/coverage.md goes through it step by step. */
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "shadow/coverage_asks.h"
#include "shadow/coverage_lists.h"
#include "shadow/coverage_packed.h"
#include "shadow/coverage_recovery.h"
#include "shadow/geometry_maps.h"
#include "shadow/shared_params.h"
#include "shadow/surrounded.h"

enum { PARAM_NODES = SHADOW_PARAM_FIT + 1, PARAM_LAYOUT, PARAM_RECOVERY };
enum { LAYOUT_EXACT, LAYOUT_PACKED };

static const char *const layout_choices[] = {"exact", "packed", NULL};
static const char *const recovery_choices[] = {"off", "on", NULL};

static const struct param_desc params[] = {
    SHADOW_MAP_PARAMS,
    {.name = "nodes",
     .unit = "triangles",
     .help = "Longest list of a texel.",
     .kind = PARAM_INT,
     .min = 1,
     .max = COVERAGE_NODES_MAX,
     .initial = 4},
    {.name = "layout",
     .unit = "",
     .help = "exact: a triangle's own plane at the point; packed: what sixteen bytes a texel tell, lists of at most 4.",
     .kind = PARAM_CHOICE,
     .min = 0,
     .max = 1,
     .initial = LAYOUT_EXACT,
     .choices = layout_choices},
    {.name = "recovery",
     .unit = "",
     .help = "Looks for small triangles that no texel kept.",
     .kind = PARAM_CHOICE,
     .min = 0,
     .max = 1,
     .initial = 1,
     .choices = recovery_choices},
};

struct state {
    struct geometry_maps maps;
    struct adjacency adjacency; /* with recovery */
};

/* True: dark. */
static bool recover(const struct state *s, const struct geometry_map *m, const struct map_point *p,
                    struct coverage_answer *answer, uint32_t *hint)
{
    for (unsigned i = 0; i < answer->besides; i++) {
        enum geometry_verdict verdict = coverage_recover(m, &s->adjacency, &answer->beside[i], p, hint);
        if (verdict == GEOMETRY_BEFORE)
            return true;
        answer->held |= verdict != GEOMETRY_ELSEWHERE;
    }
    return false;
}

/* Packed lists are as long as their links allow. */
static unsigned nodes_of(const double *values)
{
    unsigned nodes = (unsigned)values[PARAM_NODES];
    return values[PARAM_LAYOUT] == LAYOUT_PACKED && nodes > COVERAGE_PACKED_NODES ? COVERAGE_PACKED_NODES : nodes;
}

static unsigned pool_of(const double *values) { return values[PARAM_LAYOUT] == LAYOUT_PACKED ? COVERAGE_RING : COVERAGE_POOL; }

/* No ids, so no way over the mesh: what recovery there is, is surrounded(). */
static bool decide_packed(void *state, const struct geometry_map *m, const struct map_point *p, const double *values,
                          uint32_t *hint)
{
    (void)state;
    uint32_t x = (uint32_t)p->x, y = (uint32_t)p->y;
    uint32_t links = coverage_list(m, x, y, p->at, nodes_of(values), pool_of(values), hint) & COVERAGE_LINKS;
    bool held = false;
    for (; links; links &= links - 1) {
        const int8_t *step = coverage_pool[__builtin_ctz(links)];
        uint32_t i = x + (uint32_t)step[0], j = y + (uint32_t)step[1];
        enum geometry_verdict verdict = coverage_packed_ask(m, i, j, geometry_map_at(m, i, j), p, hint);
        if (verdict == GEOMETRY_BEFORE)
            return false;
        held |= verdict != GEOMETRY_ELSEWHERE;
    }
    return held || values[PARAM_RECOVERY] == 0 || !surrounded(m, p, hint);
}

static bool decide(void *state, const struct geometry_map *m, const struct map_point *p, const double *values, uint32_t *hint)
{
    const struct state *s = state;
    uint32_t x = (uint32_t)p->x, y = (uint32_t)p->y, ids[COVERAGE_NODES_MAX];
    /* In every list, and enough for most: without making one. */
    if (!coverage_list_made(m, p->at) && geometry_ask(m, m->cells[p->at].triangle, p, hint) == GEOMETRY_BEFORE)
        return false;
    uint32_t list = coverage_list(m, x, y, p->at, nodes_of(values), pool_of(values), hint);
    struct coverage_answer answer;
    coverage_ask(m, ids, coverage_list_triangles(m, x, y, list, ids), p, hint, &answer);
    if (answer.dark || (values[PARAM_RECOVERY] == 1 && recover(s, m, p, &answer, hint)))
        return false;
    return answer.held || !surrounded(m, p, hint);
}

static bool prepare(void *state, const struct shadow_input *in, struct error *err)
{
    struct state *s = state;
    if (in->params[PARAM_RECOVERY] == 1 && in->params[PARAM_LAYOUT] == LAYOUT_EXACT && !s->adjacency.across &&
        !adjacency_init(&s->adjacency, in->scene, err))
        return false;
    return geometry_maps_prepare(&s->maps, in, err);
}

static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    struct state *s = state;
    return geometry_maps_resolve(&s->maps, in, in->params[PARAM_LAYOUT] == LAYOUT_PACKED ? decide_packed : decide, s, err);
}

static void finish(void *state)
{
    struct state *s = state;
    geometry_maps_finish(&s->maps);
    adjacency_finish(&s->adjacency);
}

static size_t bytes(const void *state)
{
    const struct state *s = state;
    return geometry_maps_bytes(&s->maps) + s->adjacency.count * sizeof *s->adjacency.across;
}

/* Triangles of texel `t` of all maps, 0 where nothing is. */
static unsigned texel_triangles(struct geometry_maps *g, uint32_t size, size_t t, const double *values,
                                uint32_t out[COVERAGE_NODES_MAX])
{
    const struct geometry_map *m = &g->maps[t / size / size];
    uint32_t x = (uint32_t)(t % size), y = (uint32_t)(t / size % size), hint = 0;
    size_t at = geometry_map_at(m, x, y);
    if (at == SIZE_MAX || m->cells[at].triangle == MAP_NONE)
        return 0;
    return coverage_list_triangles(m, x, y, coverage_list(m, x, y, at, nodes_of(values), pool_of(values), &hint), out);
}

static bool read_lists(void *state, const struct shadow_input *in, struct shadow_lists *out, struct error *err)
{
    struct geometry_maps *g = &((struct state *)state)->maps;
    uint32_t size = g->count ? g->maps[0].size : (uint32_t)in->params[SHADOW_PARAM_SIZE], ids[COVERAGE_NODES_MAX];
    size_t texels = (size_t)g->count * size * size, total = 0;
    *out = (struct shadow_lists){g->count, size, malloc((texels + 1) * sizeof *out->first), NULL};
    for (size_t t = 0; out->first && t < texels; t++) {
        out->first[t] = (uint32_t)total;
        total += texel_triangles(g, size, t, in->params, ids);
    }
    if (!out->first || !(out->triangles = malloc((total + 1) * sizeof *out->triangles))) {
        free(out->first);
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the lists of %zu texels", texels);
    }
    out->first[texels] = (uint32_t)total;
    for (size_t t = 0; t < texels; t++)
        texel_triangles(g, size, t, in->params, out->triangles + out->first[t]);
    return true;
}

const struct shadow_system shadow_coverage = {
    .name = "coverage",
    .title = "Sub-pixel coverage",
    .help = "Conservative map with a list of triangles a texel; each point is tested against the triangle over it.",
    .lights = 1 << LIGHT_DIRECTIONAL | 1 << LIGHT_POINT | 1 << LIGHT_SPOT,
    .flags = SHADOW_USES_MAPS | SHADOW_BINARY | SHADOW_FILLS,
    .params = params,
    .param_count = sizeof params / sizeof *params,
    .state_size = sizeof(struct state),
    .prepare = prepare,
    .resolve = resolve,
    .finish = finish,
    .bytes = bytes,
    .read_lists = read_lists,
};
