#include "shadow/geometry/map_looks.h"

#include "shadow/geometry/geometry_kernel.h"
#include "shadow/geometry/geometry_maps.h"

static void set_bit(unsigned *bits, unsigned k, bool value) { *bits = (*bits & ~(1u << k)) | (value ? 1u << k : 0); }

static void ask_singly(const struct geometry_map *m, const struct light_part *part, struct map_looks *l, unsigned k)
{
    struct light_hit hit;
    bool holds = light_triangle_solid_hit(&m->mesh, part, l->triangle[k], l->x[k], l->y[k], &hit);
    set_bit(&l->holds, k, holds);
    set_bit(&l->before, k, holds && geometry_before(m, hit.n, l->n[k]));
}

static void look_at_wild(const struct geometry_map *m, const struct light_part *part, struct map_looks *l, unsigned k)
{
    struct light_sides s = light_triangle_sides(&m->mesh, part, l->triangle[k], l->x[k], l->y[k]);
    int most = -1;
    for (int e = 0; e < 3; e++)
        if (s.edge[e] < 0 && (most < 0 || s.edge[e] < s.edge[most]))
            most = e;
    l->beyond[k] = most;
    l->area[k] = s.area;
    set_bit(&l->may_shadow, k, true);
    ask_singly(m, part, l, k);
}

void map_look(const struct geometry_map *m, struct map_looks *l, unsigned count, uint32_t *hint)
{
    unsigned valid = (1u << count) - 1;
    for (unsigned k = count; k < LOOKS; k++)
        l->triangle[k] = l->triangle[0];
    geometry_kernel_choose()->look(m, l, hint);
    l->holds &= valid;
    l->before &= valid;
    l->may_shadow &= valid;
    for (unsigned k = 0; k < count; k++) {
        const struct light_part *part = light_mesh_part(&m->mesh, l->triangle[k], hint);
        if (l->wild >> k & 1)
            look_at_wild(m, part, l, k);
        else if (part->holes && l->holds >> k & 1)
            ask_singly(m, part, l, k);
    }
}
