/* Sub-pixel shadow map (Lecocq, Marvie, Sourimant and Gautron 2014): conservative rasterization, one triangle a texel. A point nearer than all of
 * the texel is lit; one that the texel's triangle holds and lies behind it is shadowed; anything else is uncertain and asks the
 * triangles of the eight texels around. */
#include "shadow/geometry_maps.h"
#include "shadow/shared_params.h"
#include "shadow/surrounded.h"

static const struct param_desc params[] = {SHADOW_MAP_PARAMS};

static bool is_lit(const struct geometry_map *m, const struct map_point *p, uint32_t *hint)
{
    uint32_t own = m->cells[p->at].triangle;
    enum geometry_verdict verdict = geometry_ask(m, own, p, hint);
    if (verdict == GEOMETRY_BEFORE)
        return false;
    bool held = verdict != GEOMETRY_ELSEWHERE;
    int32_t x = (int32_t)p->x, y = (int32_t)p->y;
    for (int32_t j = y - 1; j <= y + 1; j++)
        for (int32_t i = x - 1; i <= x + 1; i++) {
            uint32_t id = geometry_map_triangle(m, i, j);
            if (id == MAP_NONE || ((id ^ own) & MAP_ID) == 0)
                continue;
            verdict = geometry_ask(m, id, p, hint);
            if (verdict == GEOMETRY_BEFORE)
                return false;
            held |= verdict != GEOMETRY_ELSEWHERE;
        }
    return held || !surrounded(m, p, hint);
}

static void decide(void *state, const struct geometry_map *m, const struct map_point *points, size_t count, const double *values,
                   float *visibility)
{
    (void)state;
    (void)values;
    uint32_t hint = 0;
    for (size_t i = 0; i < count; i++)
        if (!is_lit(m, &points[i], &hint))
            visibility[points[i].pixel] = 0;
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
