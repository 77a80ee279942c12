/* A .gltf or .glb in memory, as `gnomon check` would read it. */
#include <assert.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/error.h"
#include "import/import.h"
#include "scene/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_mesh(const struct scene *scene, const struct mesh *mesh)
{
    assert((uint64_t)mesh->first_vertex + mesh->vertex_count <= scene->vertex_count);
    assert((uint64_t)mesh->first_index + mesh->index_count <= scene->index_count);
    assert(mesh->index_count % 3 == 0 && mesh->material < scene->material_count);
    for (uint32_t i = 0; i < mesh->index_count; i++)
        assert(scene->indices[mesh->first_index + i] < mesh->vertex_count);
    for (int set = 0; set < 2; set++)
        assert(mesh->first_texcoord[set] == SCENE_NONE ||
               (uint64_t)mesh->first_texcoord[set] + mesh->vertex_count <= scene->texcoord_count);
}

/* What everything behind a finished scene relies on. */
static void check_scene(const struct scene *scene)
{
    assert(scene->drawn_triangle_count < UINT32_MAX);
    for (size_t i = 0; i < scene->mesh_count; i++)
        check_mesh(scene, &scene->meshes[i]);
    for (size_t i = 0; i < scene->instance_count; i++)
        assert(scene->instances[i].mesh < scene->mesh_count);
    for (size_t i = 0; i < scene->texture_count; i++)
        assert(scene->textures[i].image < scene->image_count);
    for (size_t i = 0; i < scene->light_count; i++)
        assert(dvec3_finite(scene->lights[i].position) && dvec3_finite(scene->lights[i].direction));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct error err = {0};
    struct import_report report = {0};
    struct scene *scene = import_gltf_memory(data, size, &report, &err);
    if (scene)
        check_scene(scene);
    else
        assert(err.code != ERROR_NONE && err.code != ERROR_BUG && err.message[0]);
    free(report.warnings);
    scene_destroy(scene);
    return 0;
}
