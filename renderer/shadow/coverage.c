/* Sub-pixel coverage (Li, Yang, Han and Zhao 2017, "Coverage Detecting Algorithm Based on Sub-Pixel Geometric Primitives"): SPSM's map, and for each
 * texel a list of the triangles that neighbouring texels keep and that lie over this one too. docs/coverage.md goes through it step by step. */
#include <stdatomic.h>
#include <stdlib.h>

#include "base/error.h"
#include "gl/timer.h"
#include "shadow/geometry/coverage_asks.h"
#include "shadow/geometry/coverage_lists.h"
#include "shadow/geometry/coverage_packed.h"
#include "shadow/geometry/coverage_recovery.h"
#include "shadow/geometry/geometry_maps.h"
#include "shadow/shared_params.h"
#include "shadow/geometry/surrounded.h"

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
    /* Of the last frame. */
    _Atomic uint32_t lists_made;
    _Atomic uint64_t lists_ns; /* of all threads */
};

/* Packed lists are as long as their links allow. */
static unsigned nodes_of(const double *values)
{
    unsigned nodes = (unsigned)values[PARAM_NODES];
    return values[PARAM_LAYOUT] == LAYOUT_PACKED && nodes > COVERAGE_PACKED_NODES ? COVERAGE_PACKED_NODES : nodes;
}

static unsigned pool_of(const double *values) { return values[PARAM_LAYOUT] == LAYOUT_PACKED ? COVERAGE_RING : COVERAGE_POOL; }

/* Some of a tile's points and what the thread that decides them works with. */
struct some_points {
    struct state *state;
    const struct geometry_map *map;
    const struct map_point *points;
    size_t count;
    const double *params;
};

/* Of points that are not known to be dark. */
static void make_lists(const struct some_points *s, const uint8_t *known, struct coverage_window *w)
{
    uint32_t wanted[MAP_TILE] = {0}, any = 0;
    for (size_t i = 0; i < s->count; i++) {
        const struct map_point *p = &s->points[i];
        if (known[i] & POINT_DARK || coverage_list(s->map, p->at))
            continue;
        wanted[p->at / MAP_TILE % MAP_TILE] |= 1u << p->at % MAP_TILE;
        any = 1;
    }
    if (!any)
        return;
    double start = clock_ms();
    uint32_t made = coverage_lists_make(w, wanted, nodes_of(s->params), pool_of(s->params));
    atomic_fetch_add_explicit(&s->state->lists_made, made, memory_order_relaxed);
    atomic_fetch_add_explicit(&s->state->lists_ns, (uint64_t)((clock_ms() - start) * 1e6), memory_order_relaxed);
}

/* No ids, so no way over the mesh: what recovery there is, is surrounded(). */
static bool packed_is_lit(const struct some_points *s, const struct map_point *p, uint32_t *hint)
{
    uint32_t x = (uint32_t)p->x, y = (uint32_t)p->y;
    bool held = false;
    for (uint32_t links = coverage_list(s->map, p->at) & COVERAGE_LINKS; links; links &= links - 1) {
        const int8_t *step = coverage_pool[__builtin_ctz(links)];
        uint32_t i = x + (uint32_t)step[0], j = y + (uint32_t)step[1];
        enum geometry_verdict verdict = coverage_packed_ask(s->map, i, j, geometry_map_at(s->map, i, j), p, hint);
        if (verdict == GEOMETRY_BEFORE)
            return false;
        held |= verdict != GEOMETRY_ELSEWHERE;
    }
    return held || s->params[PARAM_RECOVERY] == 0 || !surrounded(s->map, p, hint);
}

static void decide_packed(const struct some_points *s, struct coverage_window *w, float *visibility)
{
    const uint8_t known[ASKS_POINTS] = {0};
    uint32_t hint = 0;
    make_lists(s, known, w);
    for (size_t i = 0; i < s->count; i++)
        if (!packed_is_lit(s, &s->points[i], &hint))
            visibility[s->points[i].pixel] = 0;
}

/* A texel's own triangle is in every list, and enough for most points that are dark: without a list. */
static void ask_own(const struct some_points *s, const struct coverage_window *w, struct coverage_asks *a)
{
    for (size_t i = 0; i < s->count; i++) {
        uint32_t at = s->points[i].at;
        __builtin_prefetch(&s->map->notes[at]);
        coverage_asks_put(a, (uint32_t)i, *coverage_window_id(w, at));
    }
    coverage_asks_finish_pairs(a);
}

/* The lists' triangles; the texel's own was asked. */
static void ask_lists(const struct some_points *s, const struct coverage_window *w, struct coverage_asks *a)
{
    for (size_t i = 0; i < s->count; i++) {
        uint32_t at = s->points[i].at;
        if (a->known[i] & POINT_DARK)
            continue;
        const uint32_t *id = coverage_window_id(w, at);
        for (uint32_t links = coverage_list(s->map, at) & COVERAGE_LINKS & ~1u; links; links &= links - 1)
            coverage_asks_put(a, (uint32_t)i, id[coverage_window_step((unsigned)__builtin_ctz(links))]);
    }
    coverage_asks_finish(a);
}

static void decide_exact(const struct some_points *s, struct coverage_window *w, float *visibility)
{
    struct coverage_asks a;
    const struct adjacency *adjacency = s->params[PARAM_RECOVERY] == 1 ? &s->state->adjacency : NULL;
    coverage_asks_open(&a, s->map, adjacency, s->points, s->count);
    ask_own(s, w, &a);
    make_lists(s, a.known, w);
    ask_lists(s, w, &a);
    for (size_t i = 0; i < s->count; i++)
        if (a.known[i] & POINT_DARK || (!(a.known[i] & POINT_HELD) && surrounded(s->map, &s->points[i], &a.hint)))
            visibility[s->points[i].pixel] = 0;
}

static void decide(void *state, const struct geometry_map *m, const struct map_point *points, size_t count, const double *values,
                   float *visibility)
{
    struct coverage_window w;
    coverage_window_open(&w, m, (uint32_t)points->x, (uint32_t)points->y);
    for (size_t first = 0; first < count; first += ASKS_POINTS) {
        size_t some = count - first < ASKS_POINTS ? count - first : ASKS_POINTS;
        struct some_points s = {state, m, points + first, some, values};
        (values[PARAM_LAYOUT] == LAYOUT_PACKED ? decide_packed : decide_exact)(&s, &w, visibility);
    }
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
    s->lists_made = 0;
    s->lists_ns = 0;
    return geometry_maps_resolve(&s->maps, in, decide, s, err);
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

static size_t figures(const void *state, struct shadow_figure *out)
{
    const struct state *s = state;
    out[0] = (struct shadow_figure){"lists_made", s->lists_made};
    out[1] = (struct shadow_figure){"lists_ms", (double)s->lists_ns * 1e-6};
    return 2;
}

/* Makes the lists of all texels of a map. */
static void make_all_lists(const struct geometry_map *m, const double *values)
{
    struct coverage_window w;
    for (uint32_t y = 0; y < m->size; y++)
        for (uint32_t x = 0; x < m->size; x += MAP_TILE) {
            uint32_t wanted[MAP_TILE] = {0};
            if (geometry_map_at(m, x, y) == SIZE_MAX)
                continue;
            for (uint32_t k = 0; k < MAP_TILE; k++)
                wanted[y % MAP_TILE] |= geometry_map_triangle(m, (int32_t)(x + k), (int32_t)y) != MAP_NONE ? 1u << k : 0;
            coverage_window_open(&w, m, x, y);
            coverage_lists_make(&w, wanted, nodes_of(values), pool_of(values));
        }
}

/* Triangles of texel `t` of all maps, 0 where nothing is. */
static unsigned texel_triangles(const struct geometry_maps *g, uint32_t size, size_t t, uint32_t out[COVERAGE_NODES_MAX])
{
    const struct geometry_map *m = &g->maps[t / size / size];
    uint32_t x = (uint32_t)(t % size), y = (uint32_t)(t / size % size);
    size_t at = geometry_map_at(m, x, y);
    return at == SIZE_MAX ? 0 : coverage_list_triangles(m, x, y, coverage_list(m, at), out);
}

static bool read_lists(void *state, const struct shadow_input *in, struct shadow_lists *out, struct error *err)
{
    const struct geometry_maps *g = &((struct state *)state)->maps;
    uint32_t size = g->count ? g->maps[0].size : (uint32_t)in->params[SHADOW_PARAM_SIZE], ids[COVERAGE_NODES_MAX];
    size_t texels = (size_t)g->count * size * size, total = 0;
    *out = (struct shadow_lists){g->count, size, malloc((texels + 1) * sizeof *out->first), NULL};
    for (unsigned i = 0; i < g->count; i++)
        make_all_lists(&g->maps[i], in->params);
    for (size_t t = 0; out->first && t < texels; t++) {
        out->first[t] = (uint32_t)total;
        total += texel_triangles(g, size, t, ids);
    }
    if (!out->first || !(out->triangles = malloc((total + 1) * sizeof *out->triangles))) {
        free(out->first);
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the lists of %zu texels", texels);
    }
    out->first[texels] = (uint32_t)total;
    for (size_t t = 0; t < texels; t++)
        texel_triangles(g, size, t, out->triangles + out->first[t]);
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
    .figures = figures,
};
