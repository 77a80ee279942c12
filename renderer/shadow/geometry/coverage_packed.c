#include "shadow/geometry/coverage_packed.h"

#include <math.h>

#define DEPTH_STEPS 65535.0f

struct packed {
    float x[3], y[3]; /* texels from the texel's centre */
    float n, nx, ny;  /* nearness: the texel's minimum depth, and slopes a texel */
    bool everywhere;  /* of a wild triangle the texel keeps no corners */
};

float coverage_packed_round(float value, int exponent, int mantissa, int bias)
{
    int e;
    float f = frexpf(fabsf(value), &e), scale = (float)(1 << (mantissa + 1));
    f = rintf(f * scale) / scale;
    float most = ldexpf(1 - 1 / scale, (1 << exponent) - 1 - bias);
    float rounded = ldexpf(f, e);
    if (e < -bias || !(value == value))
        return 0;
    return copysignf(rounded < most ? rounded : most, value);
}

static float coordinate(float v) { return coverage_packed_round(v, 5, 8, 15); }

static void pack_corners(const struct light_triangle *t, uint32_t x, uint32_t y, struct packed *out)
{
    out->everywhere = light_triangle_wild(t);
    for (int k = 0; k < 3; k++) {
        out->x[k] = coordinate(t->corner[k]->x - ((float)x + 0.5f));
        out->y[k] = coordinate(t->corner[k]->y - ((float)y + 0.5f));
    }
}

/* Slopes in steps of depth. */
static float slope(const struct geometry_map *m, double along, double area)
{
    float step = m->mesh.nearest / DEPTH_STEPS, steps = (float)(along / area) / step;
    return area == 0 || !isfinite(steps) ? 0 : coverage_packed_round(steps, 4, 3, 1) * step;
}

static void pack_depth(const struct geometry_map *m, const struct light_triangle *t, size_t at, struct packed *out)
{
    const struct light_vertex *a = t->corner[0], *b = t->corner[1], *c = t->corner[2];
    double bx = (double)b->x - a->x, by = (double)b->y - a->y, cx = (double)c->x - a->x, cy = (double)c->y - a->y;
    double bn = (double)b->n - a->n, cn = (double)c->n - a->n, area = bx * cy - by * cx;
    out->nx = out->everywhere ? 0 : slope(m, bn * cy - cn * by, area);
    out->ny = out->everywhere ? 0 : slope(m, cn * bx - bn * cx, area);
    float steps = ceilf(m->cells[at].nearest / m->mesh.nearest * DEPTH_STEPS);
    out->n = fminf(steps, DEPTH_STEPS) / DEPTH_STEPS * m->mesh.nearest;
}

static bool holds(const struct packed *t, float px, float py)
{
    double e[3];
    for (int k = 0; k < 3; k++) {
        int j = k == 2 ? 0 : k + 1;
        e[k] = ((double)t->x[k] - px) * ((double)t->y[j] - py) - ((double)t->x[j] - px) * ((double)t->y[k] - py);
    }
    bool inside = (e[0] >= 0 && e[1] >= 0 && e[2] >= 0) || (e[0] <= 0 && e[1] <= 0 && e[2] <= 0);
    return t->everywhere || (inside && e[0] + e[1] + e[2] != 0);
}

static bool same_corners(const struct packed *a, const struct packed *b)
{
    bool same = !a->everywhere && !b->everywhere;
    for (int k = 0; k < 3; k++)
        same &= a->x[k] == b->x[k] && a->y[k] == b->y[k];
    return same;
}

/* Whether the point's own triangle, packed for the same texel, is the one that is kept there. */
static bool is_own(const struct geometry_map *m, uint32_t x, uint32_t y, const struct packed *kept, const struct map_point *p)
{
    uint32_t hint = 0;
    const struct light_part *part = m->mesh.part_count ? light_mesh_part(&m->mesh, p->id, &hint) : NULL;
    if (!part || p->id - part->first_triangle >= part->triangle_count)
        return false;
    struct light_triangle t = light_part_triangle(part, p->id);
    struct packed own;
    pack_corners(&t, x, y, &own);
    return same_corners(&own, kept);
}

enum geometry_verdict coverage_packed_ask(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at,
                                          const struct map_point *p, uint32_t *hint)
{
    uint32_t id = m->cells[at].triangle & MAP_ID;
    const struct light_part *part = light_mesh_part(&m->mesh, id, hint);
    struct light_triangle t = light_part_triangle(part, id);
    struct packed packed;
    struct light_hit hit;
    pack_corners(&t, x, y, &packed);
    if (packed.everywhere ? id == p->id : is_own(m, x, y, &packed, p))
        return GEOMETRY_OWN;
    float px = p->x - ((float)x + 0.5f), py = p->y - ((float)y + 0.5f);
    if (!holds(&packed, px, py) || (part->holes && !light_triangle_solid_hit(&m->mesh, part, id, p->x, p->y, &hit)))
        return GEOMETRY_ELSEWHERE;
    pack_depth(m, &t, at, &packed);
    return geometry_before(m, packed.n + px * packed.nx + py * packed.ny, p->n) ? GEOMETRY_BEFORE : GEOMETRY_BEHIND;
}
