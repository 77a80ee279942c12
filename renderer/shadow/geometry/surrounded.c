#include "shadow/geometry/surrounded.h"

#include <math.h>

/* Of a wild triangle, whose corners may lie anywhere, the part over the texel's centre. */
static bool wholly_before(const struct geometry_map *m, uint32_t id, float x, float y, const struct map_point *p, uint32_t *hint)
{
    if (id == p->id)
        return false;
    const struct light_part *part = light_mesh_part(&m->mesh, id, hint);
    struct light_triangle t = light_part_triangle(part, id);
    struct light_hit hit;
    if (light_triangle_wild(&t))
        return light_triangle_hit(&m->mesh, part, id, x, y, &hit) && geometry_before(m, hit.n, p->n);
    return geometry_before(m, fminf(fminf(t.corner[0]->n, t.corner[1]->n), t.corner[2]->n), p->n);
}

bool surrounded(const struct geometry_map *m, const struct map_point *p, uint32_t *hint)
{
    int32_t x = (int32_t)floorf(p->x - 0.5f), y = (int32_t)floorf(p->y - 0.5f);
    for (int k = 0; k < 4; k++) {
        int32_t i = x + (k & 1), j = y + (k >> 1);
        uint32_t id = geometry_map_triangle(m, i, j);
        if (id & MAP_OFF_EDGE || !wholly_before(m, id, (float)i + 0.5f, (float)j + 0.5f, p, hint))
            return false;
    }
    return true;
}
