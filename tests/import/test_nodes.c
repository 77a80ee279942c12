/* Nodes, cameras, lights, materials, instancing, from files made here. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <math.h>
#include <time.h>

#include <cmocka.h>

#include "gltf_text.h"

static const float triangle[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

#define MESH                                                                                            \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"bufferViews\":[{\"buffer\":0," \
    "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}]"

static struct scene *make(const char *members) { return gltf_make(members, triangle, sizeof triangle); }

static struct dvec3 world(const struct scene *scene, size_t instance, unsigned corner)
{
    return dvec3_add(instance_vertex(scene, &scene->instances[instance], 0, corner), scene->origin);
}

static bool near(struct dvec3 a, double x, double y, double z)
{
    return fabs(a.x - x) < 1e-9 && fabs(a.y - y) < 1e-9 && fabs(a.z - z) < 1e-9;
}

static void transforms_multiply_in_double(void **state)
{
    (void)state;
    struct scene *scene = make("\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"translation\":[10000000.25,0,0],\"children\":[1]},"
                               "{\"rotation\":[0,0,0.7071067811865476,0.7071067811865476],\"scale\":[2,3,4],\"children\":[2]},"
                               "{\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1],\"mesh\":0}]," MESH);
    assert_true(near(world(scene, 0, 0), 10000000.25 - 18, 10, 28));
    assert_true(near(world(scene, 0, 1), 10000000.25 - 18, 12, 28));
    scene_destroy(scene);
    gltf_refused("\"nodes\":[{\"matrix\":[1,0,0,1,0,1,0,0,0,0,1,0,5,6,7,1],\"mesh\":0}]," MESH, triangle, sizeof triangle,
                 "last row");
    gltf_refused("\"nodes\":[{\"rotation\":[0,0,0,0]}]," MESH, triangle, sizeof triangle, "quaternion");
    gltf_refused("\"nodes\":[{\"scale\":[1e300,1,1],\"children\":[1]},{\"scale\":[1e300,1,1]}]," MESH, triangle, sizeof triangle,
                 "overflows");
}

static void only_the_default_scene(void **state)
{
    (void)state;
    const char *form =
        "%s\"scenes\":[{\"nodes\":[0]},{\"nodes\":[1,2]}],\"nodes\":[{\"mesh\":0},{\"mesh\":0},{\"mesh\":0}]," MESH;
    char members[600];
    snprintf(members, sizeof members, form, "\"scene\":1,");
    struct scene *second = make(members);
    assert_int_equal(second->instance_count, 2);
    snprintf(members, sizeof members, form, "");
    struct scene *first = make(members);
    assert_int_equal(first->instance_count, 1);
    scene_destroy(first);
    scene_destroy(second);
}

static void cameras(void **state)
{
    (void)state;
    struct scene *scene = make(
        "\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"camera\":0,\"translation\":[1,2,3],\"rotation\":[0,0.7071067811865476,0,"
        "0.7071067811865476],\"scale\":[5,5,5]},{\"camera\":1}],\"cameras\":[{\"name\":\"eye\",\"type\":\"perspective\","
        "\"perspective\":{\"yfov\":0.5,\"znear\":0.1}},{\"type\":\"orthographic\",\"orthographic\":{\"xmag\":3,\"ymag\":2,\"znear\":0,"
        "\"zfar\":9}}]," MESH);
    assert_int_equal(scene->camera_count, 2);
    const struct camera *eye = &scene->cameras[0], *flat = &scene->cameras[1];
    assert_string_equal(eye->name, "eye");
    assert_true(near(eye->back, 1, 0, 0) && near(eye->right, 0, 0, -1) && near(eye->up, 0, 1, 0) && near(eye->eye, 1, 2, 3));
    assert_true(eye->yfov == 0.5 && eye->near == 0.1 && isinf(eye->far));
    assert_true(flat->orthographic && flat->ymag == 2 && flat->near == 0 && flat->far == 9);
    scene_destroy(scene);
    gltf_refused("\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.5,\"znear\":1,\"zfar\":1}}]," MESH, triangle,
                 sizeof triangle, "greater than znear");
    gltf_refused("\"cameras\":[{\"type\":\"fisheye\"}]," MESH, triangle, sizeof triangle,
                 "Must be \"perspective\" or \"orthographic\"");
}

static void lights(void **state)
{
    (void)state;
    const char *form =
        "\"extensionsUsed\":[\"KHR_lights_punctual\"],\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"translation\":[1,2,3],\"rotation\":"
        "[-0.7071067811865476,0,0,0.7071067811865476],\"scale\":[7,7,7],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],"
        "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\",\"color\":[1,0.5,0],\"intensity\":40,\"range\":8,"
        "\"spot\":{\"innerConeAngle\":%s,\"outerConeAngle\":%s}}]}}," MESH;
    char members[1000];
    snprintf(members, sizeof members, form, "0.2", "0.6");
    struct scene *scene = make(members);
    const struct light *l = &scene->lights[0];
    assert_int_equal(scene->light_count, 1);
    assert_true(l->kind == LIGHT_SPOT && near(l->position, 1, 2, 3) && near(l->direction, 0, -1, 0));
    assert_true(l->intensity == 40 && l->color[1] == 0.5f && l->range == 8 && l->inner == 0.2 && l->outer == 0.6);
    scene_destroy(scene);
    snprintf(members, sizeof members, form, "0.6", "0.6");
    gltf_refused(members, triangle, sizeof triangle, "must be less than");
    snprintf(members, sizeof members, form, "0.6", "2");
    gltf_refused(members, triangle, sizeof triangle, "pi/2");
}

static void gpu_instancing(void **state)
{
    (void)state;
    struct {
        float triangle[3][3], at[2][3], scale[2][3];
    } data = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 5, 0}}, {{1, 1, 1}, {-2, 2, 2}}};
    struct scene *scene = gltf_make(
        "\"extensionsUsed\":[\"EXT_mesh_gpu_instancing\"],\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"],"
        "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"translation\":[0,0,9],\"extensions\":{\"EXT_mesh_gpu_instancing\":"
        "{\"attributes\":{\"TRANSLATION\":1,\"SCALE\":2}}}}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":84}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"
        "\"type\":\"VEC3\"},{\"bufferView\":0,\"byteOffset\":36,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"},"
        "{\"bufferView\":0,\"byteOffset\":60,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"}]",
        &data, sizeof data);
    assert_int_equal(scene->instance_count, 2);
    assert_true(near(world(scene, 0, 1), 2, 0, 9) && near(world(scene, 1, 1), -2, 5, 9));
    assert_true(scene->instances[1].mirrored);
    scene_destroy(scene);
}

static void materials(void **state)
{
    (void)state;
    struct scene *scene = make(
        "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
        "\"images\":[{\"uri\":\"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAD0lEQVR42mP4z8DwHwgZAA/5Av6UPD2zAAAAAElFTk"
        "SuQmCC\"}],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648,\"magFilter\":9728}],"
        "\"textures\":[{\"source\":0,\"sampler\":0}],\"materials\":[{\"alphaMode\":\"MASK\",\"alphaCutoff\":0.25,\"doubleSided\":true,"
        "\"emissiveFactor\":[1,0,0.5],\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.5,0.25,0.75],\"metallicFactor\":0,"
        "\"baseColorTexture\":{\"index\":0,\"texCoord\":1,\"extensions\":{\"KHR_texture_transform\":{\"offset\":[0.5,0.25],\"scale\":[2,3],"
        "\"rotation\":1.5707963267948966,\"texCoord\":0}}}},\"extensions\":{\"KHR_materials_unlit\":{},"
        "\"KHR_materials_emissive_strength\":{\"emissiveStrength\":4}}},{\"alphaMode\":\"BLEND\",\"alphaCutoff\":0.9}]," MESH);
    const struct material *m = &scene->materials[0];
    assert_int_equal(scene->material_count, 3);
    assert_true(m->alpha_mode == ALPHA_MASK && m->alpha_cutoff == 0.25f && m->double_sided && m->unlit && m->metallic == 0);
    assert_true(m->base_color[3] == 0.75f && m->emissive[0] == 4 && m->emissive[2] == 2 && m->roughness == 1);
    const struct texture_use *use = &m->base_color_texture;
    assert_true(use->texture == 0 && use->texcoord == 0);
    assert_true(fabsf(use->transform[0][1] - 3) < 1e-6f && fabsf(use->transform[1][0] + 2) < 1e-6f &&
                use->transform[0][2] == 0.5f);
    assert_true(scene->textures[0].wrap_s == WRAP_CLAMP_TO_EDGE && scene->textures[0].wrap_t == WRAP_MIRRORED_REPEAT);
    assert_true(scene->textures[0].nearest && scene->images[0].width == 2 && scene->images[0].height == 1);
    assert_true(scene->materials[1].alpha_cutoff == 0.5f && scene->materials[1].alpha_mode == ALPHA_BLEND);
    assert_int_equal(scene->meshes[0].material, 2);
    scene_destroy(scene);
}

/* Quadratic time in the length of an array would take minutes here. */
static void many_nodes_load_quickly(void **state)
{
    (void)state;
    const size_t count = 200000;
    char *members = malloc(3 * count + sizeof MESH + 40), *at = members;
    assert_non_null(members);
    at += sprintf(at, "\"nodes\":[{\"mesh\":0}");
    for (size_t i = 1; i < count; i++, at += 3)
        memcpy(at, ",{}", 3);
    strcpy(at, "]," MESH);
    clock_t start = clock();
    struct scene *scene = make(members);
    assert_true((double)(clock() - start) / CLOCKS_PER_SEC < 20);
    assert_int_equal(scene->instance_count, 1);
    scene_destroy(scene);
    free(members);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(transforms_multiply_in_double),
        cmocka_unit_test(only_the_default_scene),
        cmocka_unit_test(cameras),
        cmocka_unit_test(lights),
        cmocka_unit_test(gpu_instancing),
        cmocka_unit_test(materials),
        cmocka_unit_test(many_nodes_load_quickly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
