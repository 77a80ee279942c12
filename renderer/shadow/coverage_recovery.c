#include "shadow/coverage_recovery.h"

/* Triangles of a texel's size and less: the one looked for is a few edges away. */
enum { STEPS_MAX = 16 };

/* The edge that the point lies beyond, most so; -1: it lies within. */
static int edge_towards(const struct light_sides *s)
{
    int most = -1;
    for (int k = 0; k < 3; k++)
        if (s->edge[k] < 0 && (most < 0 || s->edge[k] < s->edge[most]))
            most = k;
    return most;
}

enum geometry_verdict coverage_recover(const struct geometry_map *m, const struct adjacency *adjacency,
                                       const struct coverage_way *from, const struct map_point *p, uint32_t *hint)
{
    const struct light_part *part = from->part;
    const struct mesh *mesh = &m->mesh.scene->meshes[m->mesh.scene->instances[part->instance].mesh];
    struct light_sides s = from->sides;
    uint32_t before = SCENE_NONE, id = from->id;
    for (int step = 1; step < STEPS_MAX; step++) {
        int edge = edge_towards(&s);
        if (edge < 0)
            return geometry_ask(m, id, p, hint);
        uint32_t next = adjacency_of(adjacency, mesh, id - part->first_triangle)[edge];
        if (next == SCENE_NONE || next + part->first_triangle == before)
            return GEOMETRY_ELSEWHERE;
        before = id;
        id = next + part->first_triangle;
        if (id == p->id)
            return GEOMETRY_OWN;
        double turn = s.area;
        s = light_triangle_sides(&m->mesh, part, id, p->x, p->y);
        if (turn * s.area < 0) /* folded over: the point lies beyond an outline */
            return GEOMETRY_ELSEWHERE;
    }
    return edge_towards(&s) < 0 ? geometry_ask(m, id, p, hint) : GEOMETRY_ELSEWHERE;
}
