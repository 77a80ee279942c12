/* The casters of one map as the light sees them: vertices projected to map coordinates, once a build, shared by everything that asks where a
 * triangle lies on the map.
 *
 * Map coordinates: x right, y down, in texels; nearness n = 1 / depth (perspective) or far - depth (orthographic): larger is nearer to the
 * light, and affine in x and y over a plane in both. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"
#include "scene/view.h"

struct error;
struct job_pool;

/* x is not a number where the vertex lies behind the light's plane or more than a map's side off the map: triangles with such a corner are
 * `wild` and go slower ways, in double from the scene's own vertices. */
struct light_vertex {
    float x, y, n, unused;
};

/* An instance that casts. */
struct light_part {
    uint32_t instance;
    uint32_t first_triangle, triangle_count; /* drawn ids */
    bool holes;                              /* its material has some */
    const uint32_t *indices;                 /* of its first triangle, into vertices */
    struct light_vertex *vertices;
};

struct light_mesh {
    const struct scene *scene;
    struct view view;
    double scale_x, scale_y, offset_x, offset_y; /* texels from the picture plane */
    float rounding;                              /* of a nearness, beside 2^-20 of its value */
    float nearest;                               /* nearness at the map's near plane */
    struct light_part *parts;                    /* ascending ids */
    size_t part_count;
    struct light_vertex *vertices;
    size_t vertex_count, vertex_room;
    size_t triangle_count; /* of all parts */
};

/* Projects `casters` (ascending instances). ERROR_TRY_AGAIN when memory is out. May be called again. */
bool light_mesh_project(struct light_mesh *m, const struct scene *scene, const struct view *view, const uint32_t *casters,
                        size_t caster_count, struct job_pool *pool, struct error *err);
void light_mesh_finish(struct light_mesh *m);
size_t light_mesh_bytes(const struct light_mesh *m);

/* The part of drawn triangle `id`, which is one of the mesh's. `hint`: a part index to try first; becomes the answer's. */
static inline const struct light_part *light_mesh_part(const struct light_mesh *m, uint32_t id, uint32_t *hint)
{
    const struct light_part *part = &m->parts[*hint];
    if (id - part->first_triangle < part->triangle_count)
        return part;
    size_t low = 0, count = m->part_count;
    while (count > 1) {
        size_t half = count / 2;
        if (m->parts[low + half].first_triangle <= id) {
            low += half;
            count -= half;
        } else {
            count = half;
        }
    }
    *hint = (uint32_t)low;
    return &m->parts[low];
}

/* Three projected corners of `id`. */
struct light_triangle {
    const struct light_vertex *corner[3];
};

static inline struct light_triangle light_part_triangle(const struct light_part *part, uint32_t id)
{
    const uint32_t *index = part->indices + 3 * (size_t)(id - part->first_triangle);
    return (struct light_triangle){{&part->vertices[index[0]], &part->vertices[index[1]], &part->vertices[index[2]]}};
}

/* Triangles of a tile, and a mesh's own order, jump about in memory: what comes some turns later is asked for early. */
enum { LIGHT_INDICES_AHEAD = 24, LIGHT_VERTICES_AHEAD = 12 };

static inline void light_part_prefetch_indices(const struct light_part *part, uint32_t id)
{
    if (id - part->first_triangle < part->triangle_count)
        __builtin_prefetch(part->indices + 3 * (size_t)(id - part->first_triangle));
}

static inline void light_part_prefetch_vertices(const struct light_part *part, uint32_t id)
{
    if (id - part->first_triangle >= part->triangle_count)
        return;
    const uint32_t *index = part->indices + 3 * (size_t)(id - part->first_triangle);
    for (int k = 0; k < 3; k++)
        __builtin_prefetch(&part->vertices[index[k]]);
}

static inline bool light_triangle_wild(const struct light_triangle *t)
{
    float sum = t->corner[0]->x + t->corner[1]->x + t->corner[2]->x;
    return sum != sum;
}

/* What a triangle says at a point of the map. */
struct light_hit {
    float n;         /* its nearness there */
    float weight[3]; /* of its corners, perspective-correct; sum 1 */
};

/* Wild triangles' part of light_triangle_hit(). */
bool light_wild_hit(const struct light_mesh *m, const struct light_part *part, uint32_t id, float x, float y,
                    struct light_hit *out);

/* Whether the triangle's projection holds (x, y), edges included; false for triangles of no area. */
static inline bool light_triangle_hit(const struct light_mesh *m, const struct light_part *part, uint32_t id, float x, float y,
                                      struct light_hit *out)
{
    struct light_triangle t = light_part_triangle(part, id);
    if (light_triangle_wild(&t))
        return light_wild_hit(m, part, id, x, y, out);
    const struct light_vertex *a = t.corner[0], *b = t.corner[1], *c = t.corner[2];
    double ax = (double)a->x - x, ay = (double)a->y - y, bx = (double)b->x - x, by = (double)b->y - y, cx = (double)c->x - x,
           cy = (double)c->y - y;
    double e0 = bx * cy - by * cx, e1 = cx * ay - cy * ax, e2 = ax * by - ay * bx, sum = e0 + e1 + e2;
    bool inside = ((e0 >= 0) & (e1 >= 0) & (e2 >= 0)) | ((e0 <= 0) & (e1 <= 0) & (e2 <= 0));
    if (!inside || sum == 0)
        return false;
    e0 /= sum, e1 /= sum, e2 /= sum;
    double n = e0 * a->n + e1 * b->n + e2 * c->n;
    out->n = (float)n;
    /* Affine in space: where depth is perspective, each weight times the nearness of its corner. */
    out->weight[0] = (float)(m->view.orthographic ? e0 : e0 * a->n / n);
    out->weight[1] = (float)(m->view.orthographic ? e1 : e1 * b->n / n);
    out->weight[2] = (float)(m->view.orthographic ? e2 : e2 * c->n / n);
    return true;
}

/* The same, and solid there: holes of its material are holes. */
bool light_triangle_solid_hit(const struct light_mesh *m, const struct light_part *part, uint32_t id, float x, float y,
                              struct light_hit *out);

/* On which side of its edges a point lies: twice the area that it spans with edge k (from corner k to k + 1), positive inside whichever way the
 * triangle turns; and the triangle's own, positive if it turns from +x to +y. Of wild triangles only the signs mean anything. */
struct light_sides {
    double edge[3], area;
};
struct light_sides light_triangle_sides(const struct light_mesh *m, const struct light_part *part, uint32_t id, float x, float y);

/* Zero area, exactly, or a corner that is not finite: such triangles cast nothing. */
bool light_part_degenerate(const struct scene *scene, const struct light_part *part, uint32_t id);

/* True only if a triangle with these corners (light_part_corner) touches nothing of the window of texels: all of it lies behind the light, or
 * a texel or more beyond one side. */
bool light_corners_miss(const struct light_mesh *m, const struct dvec3 corners[3], double left, double top, double right,
                        double bottom);

/* Corner k of `id` along the view's axes, in double. */
struct dvec3 light_part_corner(const struct light_mesh *m, const struct light_part *part, uint32_t id, unsigned k);
