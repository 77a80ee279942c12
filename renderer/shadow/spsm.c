/* Sub-pixel shadow map (Lecocq, Marvie, Sourimant and Gautron 2014): conservative rasterization, one triangle a texel. A point nearer than all of
 * the texel is lit; one that the texel's triangle holds and lies behind it is shadowed; anything else is uncertain and asks the
 * triangles of the eight texels around. */
#include "shadow/geometry/coverage_asks.h"
#include "shadow/geometry/geometry_maps.h"
#include "shadow/shared_params.h"
#include "shadow/geometry/surrounded.h"

static const struct param_desc params[] = {SHADOW_MAP_PARAMS};

static void ask_neighbours(struct coverage_asks *a, uint32_t point, const uint32_t *id)
{
    for (unsigned k = 1; k < COVERAGE_RING; k++) {
        uint32_t other = id[coverage_window_step(k)];
        if (other != MAP_NONE && other != *id)
            coverage_asks_put(a, point, other);
    }
}

static void decide_some(const struct coverage_window *w, const struct map_point *points, size_t count, float *visibility)
{
    struct coverage_asks a;
    coverage_asks_open(&a, w->map, NULL, points, count);
    for (size_t i = 0; i < count; i++)
        coverage_asks_put(&a, (uint32_t)i, *coverage_window_id(w, points[i].at));
    coverage_asks_finish(&a);
    for (size_t i = 0; i < count; i++)
        if (!(a.known[i] & POINT_DARK))
            ask_neighbours(&a, (uint32_t)i, coverage_window_id(w, points[i].at));
    coverage_asks_finish(&a);
    for (size_t i = 0; i < count; i++)
        if (a.known[i] & POINT_DARK || (!(a.known[i] & (POINT_HELD | POINT_COVERED)) && surrounded(w->map, &points[i], &a.hint)))
            visibility[points[i].pixel] = 0;
}

static void decide(void *state, const struct geometry_map *m, const struct map_point *points, size_t count, const double *values,
                   float *visibility)
{
    (void)state;
    (void)values;
    struct coverage_window w;
    coverage_window_open(&w, m, (uint32_t)points->x, (uint32_t)points->y);
    for (size_t first = 0; first < count; first += ASKS_POINTS)
        decide_some(&w, points + first, count - first < ASKS_POINTS ? count - first : ASKS_POINTS, visibility);
}

static bool prepare(void *state, const struct shadow_input *in, struct error *err)
{
    return geometry_maps_prepare(state, in, err);
}
static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    return geometry_maps_resolve(state, in, decide, NULL, err);
}
static void finish(void *state) { geometry_maps_finish(state); }
static size_t bytes(const void *state) { return geometry_maps_bytes(state); }

const struct shadow_system shadow_spsm = {
    .name = "spsm",
    .title = "Sub-pixel shadow map",
    .help = "Conservative: one triangle a texel and the nearest depth; what that leaves uncertain asks the texels around.",
    .lights = 1 << LIGHT_DIRECTIONAL | 1 << LIGHT_POINT | 1 << LIGHT_SPOT,
    .flags = SHADOW_USES_MAPS | SHADOW_BINARY | SHADOW_FILLS,
    .params = params,
    .param_count = sizeof params / sizeof *params,
    .state_size = sizeof(struct geometry_maps),
    .prepare = prepare,
    .resolve = resolve,
    .finish = finish,
    .bytes = bytes,
};
