#include "scene/scene.h"

#include <assert.h>
#include <stdlib.h>

#include "base/error.h"
#include "scene/finish.h"

void scene_destroy(struct scene *scene)
{
    if (!scene)
        return;
    for (size_t i = 0; scene->images && i < scene->image_count; i++)
        free(scene->images[i].rgba);
    free(scene->images);
    free(scene->textures);
    free(scene->materials);
    free(scene->cameras);
    free(scene->lights);
    free(scene->instances);
    free(scene->meshes);
    free(scene->colors);
    free(scene->texcoords);
    free(scene->indices);
    free(scene->normals);
    free(scene->positions);
    free(scene);
}

static void move_to_scene_space(struct scene *scene)
{
    struct dvec3 origin = dvec3(0, 0, 0);
    if (scene->instance_count) {
        const double *o = scene->instances[0].to_scene.offset;
        origin = dvec3(o[0], o[1], o[2]);
    }
    scene->origin = origin;
    for (size_t i = 0; i < scene->instance_count; i++) {
        double *o = scene->instances[i].to_scene.offset;
        o[0] -= origin.x;
        o[1] -= origin.y;
        o[2] -= origin.z;
        scene->instances[i].mirrored = affine_determinant(&scene->instances[i].to_scene) < 0;
    }
    for (size_t i = 0; i < scene->light_count; i++)
        scene->lights[i].position = dvec3_sub(scene->lights[i].position, origin);
    for (size_t i = 0; i < scene->camera_count; i++)
        scene->cameras[i].eye = dvec3_sub(scene->cameras[i].eye, origin);
}

static bool number_triangles(struct scene *scene, struct error *err)
{
    size_t stored = 0, drawn = 0;
    for (size_t m = 0; m < scene->mesh_count; m++)
        stored += scene->meshes[m].index_count / 3;
    for (size_t i = 0; i < scene->instance_count; i++) {
        size_t triangles = scene->meshes[scene->instances[i].mesh].index_count / 3;
        if (triangles >= SCENE_NONE - drawn)
            return error_set(err, ERROR_DATA, "instances", "the scene draws more than %u triangles, the most that ids can name",
                             SCENE_NONE - 1);
        scene->instances[i].first_triangle = (uint32_t)drawn;
        drawn += triangles;
    }
    scene->triangle_count = stored;
    scene->drawn_triangle_count = drawn;
    return true;
}

bool scene_finish(struct scene *scene, struct error *err)
{
    struct mesh_shape *shapes = NULL;
    bool ok = false;

    move_to_scene_space(scene);
    if (!number_triangles(scene, err) || !scene_order_triangles(scene, err))
        goto done;
    shapes = calloc(scene->mesh_count + 1, sizeof *shapes);
    if (!shapes) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for %zu meshes", scene->mesh_count);
        goto done;
    }
    if (!scene_find_bounds(scene, shapes, err))
        goto done;
    scene_find_planes(scene, shapes);
    scene->hash = scene_hash(scene);
    ok = true;
done:
    free(shapes);
    return ok;
}

struct dvec3 instance_vertex(const struct scene *scene, const struct instance *instance, uint32_t triangle, unsigned corner)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    assert(corner < 3 && triangle < mesh->index_count / 3);
    size_t vertex = mesh->first_vertex + (size_t)scene->indices[mesh->first_index + 3 * (size_t)triangle + corner];
    return affine_point(&instance->to_scene, dvec3_from_float(scene->positions[vertex]));
}

/* The last instance that starts at or before `id`: those without triangles start where the next one does. */
uint32_t scene_instance_of(const struct scene *scene, uint32_t id)
{
    assert(id < scene->drawn_triangle_count);
    size_t low = 0, high = scene->instance_count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (scene->instances[middle].first_triangle <= id)
            low = middle;
        else
            high = middle;
    }
    return (uint32_t)low;
}
