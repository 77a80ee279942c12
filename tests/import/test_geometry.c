/* Accessors and primitives, from files made here. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <math.h>

#include <cmocka.h>

#include "gltf_text.h"

#define ONE_NODE "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"

static const float square[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};

static struct dvec3 corner(const struct scene *scene, uint32_t triangle, unsigned k)
{
    return dvec3_add(instance_vertex(scene, &scene->instances[0], triangle, k), scene->origin);
}

static void assert_point(struct dvec3 p, double x, double y, double z)
{
    assert_true(fabs(p.x - x) < 1e-6 && fabs(p.y - y) < 1e-6 && fabs(p.z - z) < 1e-6);
}

static struct scene *square_with(const char *primitive)
{
    char members[512];
    snprintf(
        members, sizeof members,
        ONE_NODE
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}%s}]}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}]",
        primitive);
    return gltf_make(members, square, sizeof square);
}

/* Each triangle keeps the front face of the first. */
static void strips_and_fans_become_lists(void **state)
{
    (void)state;
    struct scene *strip = square_with(",\"mode\":5"), *fan = square_with(",\"mode\":6"), *list = square_with("");
    assert_int_equal(strip->triangle_count, 2);
    assert_int_equal(fan->triangle_count, 2);
    assert_int_equal(list->triangle_count, 1);
    assert_true(strip->normals[0][2] > 0.99f && strip->normals[3][2] > 0.99f);
    assert_point(corner(strip, 1, 0), 1, 0, 0);
    assert_point(corner(strip, 1, 1), 1, 1, 0);
    assert_point(corner(strip, 1, 2), 0, 1, 0);
    assert_point(corner(fan, 1, 2), 0, 0, 0);
    scene_destroy(strip);
    scene_destroy(fan);
    scene_destroy(list);
}

static void points_and_lines_are_left_out(void **state)
{
    (void)state;
    for (int mode = 0; mode < 4; mode++) {
        char text[32];
        snprintf(text, sizeof text, ",\"mode\":%d", mode);
        struct scene *scene = square_with(text);
        assert_int_equal(scene->mesh_count, 0);
        assert_int_equal(scene->drawn_triangle_count, 0);
        scene_destroy(scene);
    }
}

static void index_types(void **state)
{
    (void)state;
    const int types[] = {5121, 5123, 5125}, sizes[] = {1, 2, 4};
    for (int t = 0; t < 3; t++) {
        uint8_t data[48 + 12] = {0};
        memcpy(data, square, 48);
        const uint32_t indices[3] = {2, 0, 3};
        for (int i = 0; i < 3; i++)
            memcpy(data + 48 + i * sizes[t], &indices[i], (size_t)sizes[t]); /* little-endian */
        char members[700];
        const char *form =
            ONE_NODE "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":0},\"indices\":1}]}],"
                     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":%d}],"
                     "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
                     "{\"bufferView\":1,\"componentType\":%d,\"count\":3,\"type\":\"SCALAR\"}]";
        snprintf(members, sizeof members, form, 3 * sizes[t], types[t]);
        struct scene *scene = gltf_make(members, data, sizeof data);
        assert_int_equal(scene->vertex_count, 4);
        assert_point(corner(scene, 0, 0), 0, 1, 0);
        assert_point(corner(scene, 0, 2), 1, 1, 0);
        scene_destroy(scene);
        data[48] = 4;
        gltf_refused(members, data, sizeof data, "holds 4, but there are 4 vertices");
    }
}

/* Interleaved: position, normal, colour in one view. */
static void interleaved(void **state)
{
    (void)state;
    struct {
        float position[3], normal[3];
        uint8_t color[4];
    } vertices[3] = {
        {{0, 0, 0}, {0, 0, 2}, {255, 0, 0, 255}}, {{1, 0, 0}, {0, 0, 1}, {0, 51, 0, 0}}, {{0, 1, 0}, {0, 0, 0}, {0, 0, 0, 1}}};
    struct scene *scene = gltf_make(
        ONE_NODE "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"COLOR_0\":2}}]}],"
                 "\"bufferViews\":[{\"buffer\":0,\"byteLength\":84,\"byteStride\":28}],"
                 "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
                 "{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
                 "{\"bufferView\":0,\"byteOffset\":24,\"componentType\":5121,\"normalized\":true,\"count\":3,\"type\":\"VEC4\"}]",
        vertices, sizeof vertices);
    assert_point(corner(scene, 0, 1), 1, 0, 0);
    for (int i = 0; i < 3; i++)
        assert_true(scene->normals[i][2] == 1);
    assert_int_equal(scene->color_count, 3);
    assert_true(scene->colors[0][0] == 1 && fabsf(scene->colors[1][1] - 0.2f) < 1e-7f && scene->colors[1][3] == 0);
    scene_destroy(scene);
}

/* Colours without alpha have 1; above 1 they are cut. */
static void float_colors_of_three(void **state)
{
    (void)state;
    float data[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, 2, 0}, {0, 0, 0}, {1, 1, 1}};
    struct scene *scene =
        gltf_make(ONE_NODE "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"COLOR_0\":1}}]}],"
                           "\"bufferViews\":[{\"buffer\":0,\"byteLength\":72}],"
                           "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
                           "{\"bufferView\":0,\"byteOffset\":36,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}]",
                  data, sizeof data);
    assert_true(scene->colors[0][0] == 0.5f && scene->colors[0][1] == 1 && scene->colors[0][3] == 1);
    scene_destroy(scene);
}

#define SPARSE_FORM                                                                                                 \
    ONE_NODE "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"                                   \
             "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":4}," \
             "{\"buffer\":0,\"byteOffset\":40,\"byteLength\":24}],"                                                 \
             "\"accessors\":[{%s\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":2,"      \
             "\"indices\":{\"bufferView\":1,\"componentType\":5123},\"values\":{\"bufferView\":2}}}]"

static void sparse(void **state)
{
    (void)state;
    struct {
        float base[3][3];
        uint16_t indices[2];
        float values[2][3];
    } data = {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {0, 2}, {{-1, 0, 0}, {0, -1, 0}}};
    char over[900], zero[900];
    snprintf(over, sizeof over, SPARSE_FORM, "\"bufferView\":0,");
    snprintf(zero, sizeof zero, SPARSE_FORM, "");
    struct scene *scene = gltf_make(over, &data, sizeof data);
    assert_point(corner(scene, 0, 0), -1, 0, 0);
    assert_point(corner(scene, 0, 1), 4, 5, 6);
    assert_point(corner(scene, 0, 2), 0, -1, 0);
    scene_destroy(scene);
    scene = gltf_make(zero, &data, sizeof data);
    assert_point(corner(scene, 0, 1), 0, 0, 0);
    scene_destroy(scene);
    data.indices[1] = 3;
    gltf_refused(over, &data, sizeof data, "sparse.indices[1] is 3");
    data.indices[1] = 0;
    gltf_refused(over, &data, sizeof data, "must rise");
}

/* KHR_mesh_quantization: normalized and plain integers, scaled by the node. */
static void quantized(void **state)
{
    (void)state;
    const int16_t data[3][4] = {{-32768, 0, 32767, 0}, {16384, 0, 0, 0}, {0, 100, 0, 0}};
    const char *form = "\"extensionsUsed\":[\"KHR_mesh_quantization\"],\"extensionsRequired\":[\"KHR_mesh_quantization\"],"
                       "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"scale\":[2,2,2]}],"
                       "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                       "\"bufferViews\":[{\"buffer\":0,\"byteLength\":24,\"byteStride\":8}],"
                       "\"accessors\":[{\"bufferView\":0,\"componentType\":5122,%s\"count\":3,\"type\":\"VEC3\"}]";
    char members[700];
    snprintf(members, sizeof members, form, "\"normalized\":true,");
    struct scene *scene = gltf_make(members, data, sizeof data);
    assert_point(corner(scene, 0, 0), -2, 0, 2);
    assert_point(corner(scene, 0, 1), 2 * 16384 / 32767.0, 0, 0);
    scene_destroy(scene);
    snprintf(members, sizeof members, form, "");
    scene = gltf_make(members, data, sizeof data);
    assert_point(corner(scene, 0, 0), -65536, 0, 65534);
    scene_destroy(scene);
}

/* Same accessors: stored once, placed often. */
static void shared_data_are_stored_once(void **state)
{
    (void)state;
    struct scene *scene = gltf_make(
        "\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0},{\"mesh\":1,\"scale\":[1,-1,1]}],\"materials\":[{},{}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":0},\"material\":0},{\"attributes\":{\"POSITION\":0,"
        "\"NORMAL\":0},\"material\":1}]},{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":0},\"material\":0}]}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}]",
        square, sizeof square);
    assert_int_equal(scene->vertex_count, 3);
    assert_int_equal(scene->mesh_count, 2);
    assert_int_equal(scene->instance_count, 3);
    assert_int_equal(scene->instances[2].mesh, 0);
    assert_true(scene->instances[2].mirrored && !scene->instances[0].mirrored);
    scene_destroy(scene);
}

/* A few bytes may not unfold to gigabytes. */
static void unfolding_is_bounded(void **state)
{
    (void)state;
    size_t room = 1 << 20, used = 0;
    char *members = malloc(room);
    assert_non_null(members);
    used += (size_t)snprintf(members, room, ONE_NODE "\"meshes\":[{\"primitives\":[");
    for (int i = 0; i < 200; i++)
        used += (size_t)snprintf(members + used, room - used, "%s{\"attributes\":{\"POSITION\":%d}}", i ? "," : "", i);
    used += (size_t)snprintf(members + used, room - used, "]}],\"accessors\":[");
    for (int i = 0; i < 200; i++)
        used += (size_t)snprintf(members + used, room - used, "%s{\"componentType\":5126,\"count\":1048576,\"type\":\"VEC3\"}",
                                 i ? "," : "");
    used += (size_t)snprintf(members + used, room - used, "]");
    gltf_refused(members, square, sizeof square, "cannot justify");
    free(members);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_and_fans_become_lists),
        cmocka_unit_test(points_and_lines_are_left_out),
        cmocka_unit_test(index_types),
        cmocka_unit_test(interleaved),
        cmocka_unit_test(float_colors_of_three),
        cmocka_unit_test(sparse),
        cmocka_unit_test(quantized),
        cmocka_unit_test(shared_data_are_stored_once),
        cmocka_unit_test(unfolding_is_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
