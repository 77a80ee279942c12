/* Every scene of the shared folder loads, or is refused for an extension that the refusal names. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/error.h"
#include "import/import.h"
#include "walk.h"

/* Not scenes for this program: what must be named. */
static const struct {
    const char *file, *part;
} refused[] = {
    {"asset-generator/Compatibility/Compatibility_04.gltf", "minVersion"},
    {"asset-generator/Compatibility/Compatibility_05.gltf", "FAKE_materials_quantumRendering"},
    {"ball-carbon60-draco.glb", "KHR_draco_mesh_compression"},
    {"chess-board-draco.glb", "KHR_draco_mesh_compression"},
    {"gltf-transform/BoxDraco.gltf", "KHR_draco_mesh_compression"},
    {"gltf-transform/BoxMeshopt.glb", "EXT_meshopt_compression"},
    {"gltf-transform/DracoSparseMesh.gltf", "KHR_draco_mesh_compression"},
    {"khronos/Avocado-Draco-geo.glb", "KHR_draco_mesh_compression"},
    {"khronos/Lantern-Draco-geo.glb", "KHR_draco_mesh_compression"},
    {"khronos/StainedGlassLamp-KTX2.glb", "KHR_texture_basisu"},
};

/* Triangles stored and drawn, as the folder's README counts them. */
static const struct {
    const char *file;
    size_t stored, drawn;
} counted[] = {
    {"TeapotsGalore/TeapotsGalore.gltf", 4034, 7656770}, {"dragon/dragon-ground.gltf", 871416, 871416},
    {"ball-lattice-ground.glb", 46082, 46082},           {"butterfly-ground.glb", 6522, 6522},
    {"grove-oak-30-ground.glb", 54248, 1627382},         {"khronos/GlassVaseFlowers.glb", 10218, 14036},
    {"khronos/NegativeScaleTest.glb", 3884, 7724},       {"khronos/ReciprocatingSaw.glb", 139594, 198470},
    {"khronos/RecursiveSkeletons.glb", 76, 6384},        {"khronos/SimpleInstancing.glb", 12, 1500},
    {"tree-oak-geoleaf-ground.glb", 54248, 54248},       {"tree-oak-ground.glb", 22568, 22568},
};

static unsigned loaded;

static const char *refusal_of(const char *file)
{
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        if (strcmp(refused[i].file, file) == 0)
            return refused[i].part;
    return NULL;
}

static void check_counts(const struct scene *scene, const char *file)
{
    for (size_t i = 0; i < sizeof counted / sizeof *counted; i++) {
        if (strcmp(counted[i].file, file) != 0)
            continue;
        if (scene->triangle_count != counted[i].stored || scene->drawn_triangle_count != counted[i].drawn)
            fail_msg("%s: %zu stored, %zu drawn", file, scene->triangle_count, scene->drawn_triangle_count);
    }
}

static void check_scene(const struct scene *scene, const char *file)
{
    for (size_t m = 0; m < scene->mesh_count; m++) {
        const struct mesh *mesh = &scene->meshes[m];
        assert_true(mesh->index_count % 3 == 0 && mesh->material < scene->material_count);
        assert_true((size_t)mesh->first_vertex + mesh->vertex_count <= scene->vertex_count);
        assert_true((size_t)mesh->first_index + mesh->index_count <= scene->index_count);
        for (size_t i = 0; i < mesh->index_count; i++)
            if (scene->indices[mesh->first_index + i] >= mesh->vertex_count)
                fail_msg("%s: mesh %zu, index %zu", file, m, i);
    }
    for (size_t v = 0; v < scene->vertex_count; v++) {
        const float *n = scene->normals[v];
        if (!(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f))
            fail_msg("%s: normal %zu is not unit", file, v);
    }
    check_counts(scene, file);
}

static void load(const char *path, const char *below)
{
    struct error err = {0};
    struct import_report report = {0};
    struct scene *scene = import_gltf(path, &report, &err);
    const char *part = refusal_of(below);
    if (part && (scene || err.code != ERROR_DATA || !strstr(err.message, part)))
        fail_msg("%s: should be refused for %s: %s", below, part, err.message);
    if (!part && !scene)
        fail_msg("%s", err.message);
    if (scene) {
        check_scene(scene, below);
        loaded++;
    }
    free(report.warnings);
    scene_destroy(scene);
}

static void every_scene(void **state)
{
    (void)state;
    if (access(SHARED_DIR "/scenes", R_OK) != 0)
        skip();
    walk(SHARED_DIR "/scenes", load);
    assert_true(loaded > 150);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_scene)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
