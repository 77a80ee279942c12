#include "exact/triangles.h"

#include <stdlib.h>
#include <string.h>

#include "reference/filter.h"

static size_t drawn_vertices(const struct scene *scene)
{
    size_t count = 0;
    for (size_t i = 0; i < scene->instance_count; i++)
        count += scene->meshes[scene->instances[i].mesh].vertex_count;
    return count;
}

size_t triangles_bytes(const struct scene *scene)
{
    return drawn_vertices(scene) * sizeof(struct dvec3) + scene->drawn_triangle_count * (3 * sizeof(uint32_t) + 1) +
           hole_masks_bytes(scene);
}

static bool counts(struct dvec3 p)
{
    return fabs(p.x) <= FILTER_COORDINATE_MAX && fabs(p.y) <= FILTER_COORDINATE_MAX && fabs(p.z) <= FILTER_COORDINATE_MAX;
}

static uint8_t flags_of(const struct scene *scene, const struct instance *instance)
{
    const struct material *material = &scene->materials[scene->meshes[instance->mesh].material];
    uint8_t sides = material->double_sided ? 0 : instance->mirrored ? TRIANGLE_HIDDEN_MIRRORED : TRIANGLE_HIDDEN_BACK;
    return (uint8_t)(sides | (material_has_holes(material) ? TRIANGLE_HOLES : 0));
}

static void add_instance(struct triangles *t, const struct instance *instance, size_t first_vertex)
{
    const struct scene *scene = t->scene;
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    const uint8_t flags = flags_of(scene, instance);
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        t->vertices[first_vertex + i] =
            affine_point(&instance->to_scene, dvec3_from_float(scene->positions[mesh->first_vertex + i]));
    for (uint32_t i = 0; i < mesh->index_count / 3; i++) {
        uint32_t id = instance->first_triangle + i;
        bool ok = true;
        for (int k = 0; k < 3; k++) {
            uint32_t vertex = (uint32_t)(first_vertex + scene->indices[mesh->first_index + 3 * (size_t)i + (unsigned)k]);
            t->corners[id][k] = vertex;
            ok &= counts(t->vertices[vertex]);
        }
        t->flags[id] = (uint8_t)(flags | (ok ? 0 : TRIANGLE_IGNORED));
        for (int k = 0; ok && k < 3; k++)
            dbox_add(&t->bounds, t->vertices[t->corners[id][k]]);
    }
}

bool triangles_init(struct triangles *t, const struct scene *scene)
{
    *t = (struct triangles){.scene = scene,
                            .count = (uint32_t)scene->drawn_triangle_count,
                            .vertex_count = drawn_vertices(scene),
                            .bounds = dbox_empty()};
    if (t->vertex_count >= UINT32_MAX)
        return false;
    t->vertices = malloc((t->vertex_count + 1) * sizeof *t->vertices);
    t->corners = malloc(((size_t)t->count + 1) * sizeof *t->corners);
    t->flags = malloc((size_t)t->count + 1);
    if (!t->vertices || !t->corners || !t->flags || !hole_masks_init(&t->masks, scene))
        return false;
    size_t first = 0;
    for (size_t i = 0; i < scene->instance_count; i++) {
        add_instance(t, &scene->instances[i], first);
        first += scene->meshes[scene->instances[i].mesh].vertex_count;
    }
    return true;
}

void triangles_finish(struct triangles *t)
{
    free(t->vertices);
    free(t->corners);
    free(t->flags);
    hole_masks_finish(&t->masks);
    memset(t, 0, sizeof *t);
}
