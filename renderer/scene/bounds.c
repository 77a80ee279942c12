#include <stdlib.h>

#include "base/error.h"
#include "scene/finish.h"

/* Distances up to this fraction of an extent count as "in the plane". */
#define PLANAR_TOLERANCE 1e-6

/* The finite vertices of one mesh that its triangles use, each once. */
struct used_vertices {
    uint32_t *stamp;    /* per scene vertex: the number of the last mesh that used it */
    uint32_t *vertices; /* scene vertices */
    size_t count;
};

/* Instances in the order of their meshes. */
struct by_mesh {
    uint32_t *first; /* mesh_count + 1 */
    uint32_t *instances;
};

static bool finite3(const float v[3]) { return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]); }

static void collect_used(const struct scene *scene, uint32_t mesh_index, struct used_vertices *used)
{
    const struct mesh *mesh = &scene->meshes[mesh_index];
    used->count = 0;
    for (size_t i = 0; i < mesh->index_count; i++) {
        size_t vertex = mesh->first_vertex + (size_t)scene->indices[mesh->first_index + i];
        if (used->stamp[vertex] == mesh_index + 1)
            continue;
        used->stamp[vertex] = mesh_index + 1;
        if (finite3(scene->positions[vertex]))
            used->vertices[used->count++] = (uint32_t)vertex;
    }
}

static void bound_mesh(const struct scene *scene, struct mesh *mesh, const struct used_vertices *used)
{
    for (int k = 0; k < 3; k++) {
        mesh->bounds_min[k] = INFINITY;
        mesh->bounds_max[k] = -INFINITY;
    }
    for (size_t i = 0; i < used->count; i++) {
        const float *p = scene->positions[used->vertices[i]];
        for (int k = 0; k < 3; k++) {
            mesh->bounds_min[k] = p[k] < mesh->bounds_min[k] ? p[k] : mesh->bounds_min[k];
            mesh->bounds_max[k] = p[k] > mesh->bounds_max[k] ? p[k] : mesh->bounds_max[k];
        }
    }
}

static struct dvec3 triangle_cross(const struct scene *scene, const struct mesh *mesh, size_t triangle, struct dvec3 *corner)
{
    const uint32_t *i = &scene->indices[mesh->first_index + 3 * triangle];
    const float(*p)[3] = (const float(*)[3])scene->positions + mesh->first_vertex;
    struct dvec3 a = dvec3_from_float(p[i[0]]);
    *corner = a;
    return dvec3_cross(dvec3_sub(dvec3_from_float(p[i[1]]), a), dvec3_sub(dvec3_from_float(p[i[2]]), a));
}

static uint32_t largest_triangle(const struct scene *scene, const struct mesh *mesh)
{
    uint32_t largest = SCENE_NONE;
    double most = 0;
    for (size_t t = 0; t < mesh->index_count / 3; t++) {
        struct dvec3 corner, n = triangle_cross(scene, mesh, t, &corner);
        double size = dvec3_dot(n, n);
        if (size > most && isfinite(size)) {
            most = size;
            largest = (uint32_t)t;
        }
    }
    return largest;
}

static bool mesh_is_planar(const struct scene *scene, const struct mesh *mesh, const struct mesh_shape *shape,
                           const struct used_vertices *used)
{
    if (shape->largest_triangle == SCENE_NONE)
        return false;
    struct dvec3 corner, normal = dvec3_normalize(triangle_cross(scene, mesh, shape->largest_triangle, &corner));
    struct dvec3 diagonal = dvec3_sub(dvec3_from_float(mesh->bounds_max), dvec3_from_float(mesh->bounds_min));
    double allowed = PLANAR_TOLERANCE * dvec3_length(diagonal);
    for (size_t i = 0; i < used->count; i++) {
        struct dvec3 p = dvec3_from_float(scene->positions[used->vertices[i]]);
        if (!(fabs(dvec3_dot(dvec3_sub(p, corner), normal)) <= allowed))
            return false;
    }
    return true;
}

static struct dbox bound_instance(const struct scene *scene, const struct affine *to_scene, const struct used_vertices *used)
{
    struct dbox box = dbox_empty();
    for (size_t i = 0; i < used->count; i++) {
        struct dvec3 p = affine_point(to_scene, dvec3_from_float(scene->positions[used->vertices[i]]));
        if (dvec3_finite(p))
            dbox_add(&box, p);
    }
    return box;
}

static void sort_by_mesh(const struct scene *scene, struct by_mesh *sorted)
{
    for (size_t i = 0; i < scene->instance_count; i++)
        sorted->first[scene->instances[i].mesh + 1]++;
    for (size_t m = 0; m < scene->mesh_count; m++)
        sorted->first[m + 1] += sorted->first[m];
    for (size_t i = scene->instance_count; i-- > 0;)
        sorted->instances[--sorted->first[scene->instances[i].mesh + 1]] = (uint32_t)i;
    /* first[m + 1] is now where mesh m starts: shift back. */
    for (size_t m = 0; m < scene->mesh_count; m++)
        sorted->first[m] = sorted->first[m + 1];
    sorted->first[scene->mesh_count] = (uint32_t)scene->instance_count;
}

static void find_bounds(struct scene *scene, struct mesh_shape *shapes, struct used_vertices *used, const struct by_mesh *sorted)
{
    scene->bounds = dbox_empty();
    for (size_t m = 0; m < scene->mesh_count; m++) {
        struct mesh *mesh = &scene->meshes[m];
        collect_used(scene, (uint32_t)m, used);
        bound_mesh(scene, mesh, used);
        shapes[m].largest_triangle = largest_triangle(scene, mesh);
        mesh->planar = mesh_is_planar(scene, mesh, &shapes[m], used);
        for (size_t i = sorted->first[m]; i < sorted->first[m + 1]; i++) {
            struct instance *instance = &scene->instances[sorted->instances[i]];
            instance->bounds = bound_instance(scene, &instance->to_scene, used);
            if (!dbox_is_empty(&instance->bounds)) {
                dbox_add(&scene->bounds, instance->bounds.min);
                dbox_add(&scene->bounds, instance->bounds.max);
            }
        }
    }
}

bool scene_find_bounds(struct scene *scene, struct mesh_shape *shapes, struct error *err)
{
    struct used_vertices used = {0};
    struct by_mesh sorted = {0};
    used.stamp = calloc(scene->vertex_count + 1, sizeof *used.stamp);
    used.vertices = malloc((scene->vertex_count + 1) * sizeof *used.vertices);
    sorted.first = calloc(scene->mesh_count + 1, sizeof *sorted.first);
    sorted.instances = malloc((scene->instance_count + 1) * sizeof *sorted.instances);
    bool ok = used.stamp && used.vertices && sorted.first && sorted.instances;
    if (ok) {
        sort_by_mesh(scene, &sorted);
        find_bounds(scene, shapes, &used, &sorted);
    } else {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the bounds of %zu vertices", scene->vertex_count);
    }
    free(sorted.instances);
    free(sorted.first);
    free(used.vertices);
    free(used.stamp);
    return ok;
}
