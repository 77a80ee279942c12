/* Every built-in scene: it can be made at its default and at the ends of each parameter, and is what it promises to be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "builtin/builtin.h"

static struct scene *make(const char *name)
{
    struct error err = {0};
    struct scene *scene = builtin_make(name, &err);
    if (!scene)
        fail_msg("%s: %s", name, err.message);
    return scene;
}

static bool is_unit(const float v[3])
{
    double length = sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
    return fabs(length - 1) < 1e-5;
}

static void check_mesh(const struct scene *scene, const struct mesh *m, bool finite)
{
    assert_true(m->material < scene->material_count);
    assert_int_equal(m->index_count % 3, 0);
    assert_true((size_t)m->first_vertex + m->vertex_count <= scene->vertex_count);
    assert_true((size_t)m->first_index + m->index_count <= scene->index_count);
    if (m->first_color != SCENE_NONE)
        assert_true((size_t)m->first_color + m->vertex_count <= scene->color_count);
    for (uint32_t i = 0; i < m->index_count; i++)
        if (scene->indices[m->first_index + i] >= m->vertex_count)
            fail_msg("%s, %s: index %u out of range", scene->name, m->name, i);
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        const float *p = scene->positions[m->first_vertex + i];
        if (finite && !(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
            fail_msg("%s, %s: vertex %u is not finite", scene->name, m->name, i);
        if (!is_unit(scene->normals[m->first_vertex + i]))
            fail_msg("%s, %s: normal %u is not unit", scene->name, m->name, i);
    }
}

static void check_scene(const struct scene *scene)
{
    bool finite = !strstr(scene->name, "degenerate");
    assert_true(scene->light_count > 0);
    assert_true(scene->camera_count > 0);
    assert_true(scene->drawn_triangle_count > 0);
    assert_false(dbox_is_empty(&scene->bounds));
    assert_true(dvec3_finite(scene->bounds.min) && dvec3_finite(scene->bounds.max));
    for (size_t i = 0; i < scene->color_count; i++)
        for (int k = 0; k < 4; k++)
            assert_true(scene->colors[i][k] >= 0 && scene->colors[i][k] <= 1);
    for (size_t i = 0; i < scene->mesh_count; i++)
        check_mesh(scene, &scene->meshes[i], finite);
    struct light light = scene->lights[0];
    if (light.kind != LIGHT_POINT)
        assert_true(fabs(dvec3_length(light.direction) - 1) < 1e-15);
}

static void make_and_check(const char *name)
{
    struct scene *scene = make(name);
    check_scene(scene);
    scene_destroy(scene);
}

static void test_defaults(void **state)
{
    (void)state;
    for (size_t i = 0; i < builtin_count; i++)
        make_and_check(builtin_list[i]->name);
}

static void test_parameter_ends(void **state)
{
    (void)state;
    for (size_t i = 0; i < builtin_count; i++)
        for (const struct builtin_param *p = builtin_list[i]->params; p && p->name; p++) {
            char name[128];
            snprintf(name, sizeof name, "%s:%s=%.10g", builtin_list[i]->name, p->name, p->min);
            make_and_check(name);
            snprintf(name, sizeof name, "%s:%s=%.10g", builtin_list[i]->name, p->name, p->max);
            make_and_check(name);
        }
}

static void test_same_name_same_bits(void **state)
{
    (void)state;
    for (size_t i = 0; i < builtin_count; i++) {
        struct scene *once = make(builtin_list[i]->name), *again = make(builtin_list[i]->name);
        assert_true(once->hash == again->hash);
        assert_int_equal(once->vertex_count, again->vertex_count);
        assert_memory_equal(once->positions, again->positions, once->vertex_count * sizeof *once->positions);
        scene_destroy(again);
        scene_destroy(once);
    }
}

/* The coverage shadow map paper's table 2, and what a scene was asked for. */
static void test_triangle_counts(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t triangles;
        double tolerance;
    } wanted[] = {
        {"ball", 39936, 0.005},
        {"tree", 46036, 0},
        {"butterfly", 73138, 0.015},
        {"butterfly:triangles=30000", 30000, 0.05},
        {"dragon", 870000, 1e-4},
        {"dragon:triangles=1000", 1000, 0.02},
        {"dragon:triangles=47800", 47800, 0.001},
        {"dragon:triangles=2500000", 2500000, 1e-4},
        {"tree:leaves=0", 21970, 0.02},
        {"room", 12 + 31000, 0.01},
        {"hard-08-depth:triangles=4096", 4096 + 2 + 24, 0},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        struct scene *scene = make(wanted[i].name);
        double miss = fabs((double)scene->drawn_triangle_count - (double)wanted[i].triangles);
        if (miss > wanted[i].tolerance * (double)wanted[i].triangles)
            fail_msg("%s: %zu triangles, not about %zu", wanted[i].name, scene->drawn_triangle_count, wanted[i].triangles);
        scene_destroy(scene);
    }
}

static const struct instance *find_instance(const struct scene *scene, const char *mesh_name)
{
    for (size_t i = 0; i < scene->instance_count; i++)
        if (strcmp(scene->meshes[scene->instances[i].mesh].name, mesh_name) == 0)
            return &scene->instances[i];
    fail_msg("%s has no %s", scene->name, mesh_name);
    return NULL;
}

static void test_models_stand_on_a_planar_ground(void **state)
{
    (void)state;
    static const char *const models[] = {"box",        "ball", "tree", "butterfly", "dragon:triangles=50000", "hard-04-contact",
                                         "hard-06-fan"};
    for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
        struct scene *scene = make(models[i]);
        const struct instance *ground = find_instance(scene, "ground");
        assert_true(scene->meshes[ground->mesh].planar);
        assert_int_equal(ground->others_side, 1);
        double lowest = INFINITY;
        for (size_t k = 0; k < scene->instance_count; k++)
            if (&scene->instances[k] != ground)
                lowest = fmin(lowest, scene->instances[k].bounds.min.y);
        if (strcmp(models[i], "hard-06-fan") != 0 && !(fabs(lowest) < 1e-3))
            fail_msg("%s stands at y = %g", models[i], lowest);
        scene_destroy(scene);
    }
}

/* A directed edge, as one number for sorting. */
static int compare_edges(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Every directed edge occurs once, and its opposite once. */
static void check_closed(const struct scene *scene, const struct mesh *m)
{
    const uint32_t *v = scene->indices + m->first_index;
    uint64_t *edges = malloc(m->index_count * sizeof *edges);
    assert_non_null(edges);
    for (uint32_t i = 0; i < m->index_count; i++) {
        uint32_t next = i % 3 == 2 ? i - 2 : i + 1;
        edges[i] = (uint64_t)v[i] << 32 | v[next];
    }
    qsort(edges, m->index_count, sizeof *edges, compare_edges);
    for (uint32_t i = 0; i < m->index_count; i++) {
        uint64_t opposite = edges[i] << 32 | edges[i] >> 32;
        if ((i > 0 && edges[i] == edges[i - 1]) || !bsearch(&opposite, edges, m->index_count, sizeof *edges, compare_edges))
            fail_msg("%s: the edge from %u to %u has not one triangle on either side", scene->name, (unsigned)(edges[i] >> 32),
                     (unsigned)edges[i]);
    }
    free(edges);
}

/* Six times the volume enclosed; positive when the triangles face outwards. */
static double enclosed(const struct scene *scene, const struct mesh *m)
{
    double sum = 0;
    for (uint32_t i = 0; i < m->index_count; i += 3) {
        const uint32_t *v = scene->indices + m->first_index + i;
        struct dvec3 p = dvec3_from_float(scene->positions[m->first_vertex + v[0]]);
        struct dvec3 q = dvec3_from_float(scene->positions[m->first_vertex + v[1]]);
        struct dvec3 r = dvec3_from_float(scene->positions[m->first_vertex + v[2]]);
        sum += dvec3_dot(p, dvec3_cross(q, r));
    }
    return sum;
}

static void check_mesh_closed(const char *name, const char *mesh_name)
{
    struct scene *scene = make(name);
    const struct mesh *m = &scene->meshes[find_instance(scene, mesh_name)->mesh];
    check_closed(scene, m);
    assert_true(enclosed(scene, m) > 0);
    scene_destroy(scene);
}

static void test_closed_surfaces(void **state)
{
    (void)state;
    check_mesh_closed("dragon:triangles=1000", "dragon");
    check_mesh_closed("dragon:triangles=1234", "dragon");
    check_mesh_closed("dragon:triangles=100001", "dragon");
    check_mesh_closed("dragon", "dragon");
    check_mesh_closed("hard-06-fan", "lens");
    check_mesh_closed("hard-06-fan:sides=3", "lens");
    check_mesh_closed("hard-06-fan", "ball");
}

/* hard-21: a light ray through a corner of a flat caster meets the floor at a pixel centre, without any rounding. */
static void test_grid_corners_fall_on_pixel_centres(void **state)
{
    (void)state;
    struct scene *scene = make("hard-21-grid");
    const struct mesh *m = &scene->meshes[find_instance(scene, "casters")->mesh];
    struct dvec3 d = scene->lights[0].direction;
    assert_true(d.y == -4 * d.x && d.z == 2 * d.x);
    uint32_t corners = 0;
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        const float *p = scene->positions[m->first_vertex + i];
        if (p[1] < 10)
            continue;
        double x = p[0] + p[1] / 4.0, z = p[2] + p[1] / 2.0;
        assert_true(x - floor(x) == 0.5 && z - floor(z) == 0.5);
        assert_true(fabs(x) < 32 && fabs(z) < 32);
        corners++;
    }
    assert_true(corners > 60);
    scene_destroy(scene);
}

/* hard-11: the bad triangles are there, and leave the bounds alone. */
static void test_degenerate_keeps_bounds(void **state)
{
    (void)state;
    struct scene *with = make("hard-11-degenerate"), *without = make("hard-11-degenerate:bad=0");
    assert_true(with->drawn_triangle_count == without->drawn_triangle_count + 6 * 8);
    assert_memory_equal(&with->bounds, &without->bounds, sizeof with->bounds);
    scene_destroy(without);
    scene_destroy(with);
}

static void refuse_as(enum error_code code, const char *name, const char *expected)
{
    struct error err = {0};
    struct scene *scene = builtin_make(name, &err);
    assert_null(scene);
    assert_int_equal(err.code, code);
    if (!strstr(err.message, expected))
        fail_msg("'%s' was refused with '%s', which does not say '%s'", name, err.message, expected);
}

static void refuse(const char *name, const char *expected) { refuse_as(ERROR_USAGE, name, expected); }

static void test_refusals(void **state)
{
    (void)state;
    refuse_as(ERROR_NO_INPUT, "", "known are box, ball, tree, butterfly, dragon");
    refuse_as(ERROR_NO_INPUT, "boxx", "hard-01-grazing to hard-25-sheets");
    refuse("dragon:", "not key=value");
    refuse("dragon:triangles", "not key=value");
    refuse("dragon:=5", "not key=value");
    refuse("dragon:triangles=5000,", "not key=value");
    refuse("dragon:triangle=5000", "it takes triangles");
    refuse("box:triangles=5000", "it takes none");
    refuse("ball:frequency=4,frequency=4", "given twice");
    refuse("dragon:triangles=999", "from 1000 to 2500000");
    refuse("dragon:triangles=2500001", "from 1000 to 2500000");
    refuse("dragon:triangles=5000.5", "whole number");
    static const char *const bad_values[] = {"", "nan", "inf", "0x2000", " 5000", "5000 ", "1e400", "5e", "-", "five", "5000=1"};
    for (size_t i = 0; i < sizeof bad_values / sizeof bad_values[0]; i++) {
        char name[64];
        snprintf(name, sizeof name, "dragon:triangles=%s", bad_values[i]);
        refuse(name, "is not a value for triangles");
    }
    char longest[5000];
    memset(longest, 'a', sizeof longest - 1);
    longest[sizeof longest - 1] = 0;
    refuse(longest, "too long");
}

static void test_values_are_taken(void **state)
{
    (void)state;
    struct scene *scene = make("ball:wire=0.001,frequency=2");
    assert_int_equal(scene->drawn_triangle_count, 320 * (4 + 1) + 2 * 16 + 2);
    assert_string_equal(scene->name, "builtin:ball:wire=0.001,frequency=2");
    scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_parameter_ends),
        cmocka_unit_test(test_same_name_same_bits),
        cmocka_unit_test(test_triangle_counts),
        cmocka_unit_test(test_models_stand_on_a_planar_ground),
        cmocka_unit_test(test_closed_surfaces),
        cmocka_unit_test(test_grid_corners_fall_on_pixel_centres),
        cmocka_unit_test(test_degenerate_keeps_bounds),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_values_are_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
