/* Reconstructable geometry shadow map (as Li et al. 2017, papers/coverage-li-2017, tell of their reference 18): each texel names the triangle seen through
 * its centre, and a point is tested against the plane of that triangle at its own position, so the test is continuous over a texel. */
#include <math.h>

#include "shadow/geometry/geometry_maps.h"
#include "shadow/shared_params.h"

static const struct param_desc params[] = {SHADOW_MAP_PARAMS};

/* The plane's nearness at the point; where the triangle is seen edge-on, its nearest corner's. */
static float plane_at(const struct light_triangle *t, float x, float y)
{
    const struct light_vertex *a = t->corner[0], *b = t->corner[1], *c = t->corner[2];
    double bx = (double)b->x - a->x, by = (double)b->y - a->y, cx = (double)c->x - a->x, cy = (double)c->y - a->y;
    double area = bx * cy - by * cx, bn = (double)b->n - a->n, cn = (double)c->n - a->n;
    double most = fmax(fmax(a->n, b->n), c->n), px = (double)x - a->x, py = (double)y - a->y;
    double n = a->n + ((bn * cy - cn * by) * px + (cn * bx - bn * cx) * py) / area;
    return isfinite(n) ? (float)n : (float)most;
}

/* The same where the corners are not all on the map (perspective: an orthographic map holds its casters). */
static float wild_plane_at(const struct light_mesh *m, const struct light_part *part, uint32_t id, float x, float y)
{
    struct dvec3 c[3];
    for (unsigned k = 0; k < 3; k++)
        c[k] = light_part_corner(m, part, id, k);
    struct dvec3 normal = dvec3_cross(dvec3_sub(c[1], c[0]), dvec3_sub(c[2], c[0]));
    struct dvec3 towards = dvec3((x - m->offset_x) / m->scale_x, (y - m->offset_y) / m->scale_y, 1);
    double n = dvec3_dot(normal, towards) / dvec3_dot(normal, c[0]);
    return isfinite(n) ? (float)n : 0;
}

static bool is_lit(const struct geometry_map *m, const struct map_point *p, uint32_t *hint)
{
    uint32_t id = m->cells[p->at].triangle;
    if (id & MAP_OFF_EDGE || id == p->id)
        return true;
    const struct light_part *part = light_mesh_part(&m->mesh, id, hint);
    struct light_triangle t = light_part_triangle(part, id);
    float plane = light_triangle_wild(&t) ? wild_plane_at(&m->mesh, part, id, p->x, p->y) : plane_at(&t, p->x, p->y);
    return !geometry_before(m, plane, p->n);
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

const struct shadow_system shadow_rgsm = {
    .name = "rgsm",
    .title = "Reconstructable geometry shadow map",
    .help = "The triangle seen through each texel's centre; a point is tested against its plane.",
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
