/* Which maps a light gets and what they see (shadow/fit.h). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "made_scene.h"
#include "shadow/fit.h"

#define SIZE 512

/* A scene with its boxes and the last fit. */
struct setting {
    struct scene *scene;
    struct fit_geometry geometry;
    uint32_t *casters;
    struct shadow_fit fit;
};

static struct setting setting_open(struct scene *scene)
{
    struct error err = {0};
    struct setting c = {.scene = scene, .casters = calloc(scene->instance_count + 1, sizeof *c.casters)};
    assert_non_null(c.casters);
    assert_true(fit_geometry_init(&c.geometry, scene, &err));
    return c;
}

static struct setting setting_load(const char *name)
{
    struct error err = {0};
    struct scene *scene = scene_load(name, &err);
    if (!scene)
        fail_msg("%s: %s", name, err.message);
    return setting_open(scene);
}

static void setting_close(struct setting *c)
{
    fit_geometry_finish(&c->geometry);
    scene_destroy(c->scene);
    free(c->casters);
}

static void check_view(const struct view *v, double fov, bool directional)
{
    assert_int_equal(v->width, SIZE);
    assert_int_equal(v->height, SIZE);
    assert_true(v->orthographic == directional);
    assert_true(dvec3_finite(v->eye) && dvec3_finite(v->right) && dvec3_finite(v->up) && dvec3_finite(v->forward));
    assert_true(fabs(dvec3_length(v->right) - 1) < 1e-12 && fabs(dvec3_length(v->up) - 1) < 1e-12 &&
                fabs(dvec3_length(v->forward) - 1) < 1e-12);
    assert_true(fabs(dvec3_dot(v->right, v->up)) < 1e-12 && fabs(dvec3_dot(v->right, v->forward)) < 1e-12 &&
                fabs(dvec3_dot(v->up, v->forward)) < 1e-12);
    assert_true(isfinite(v->left) && isfinite(v->bottom) && v->left < v->right_edge && v->bottom < v->top);
    assert_true(v->near < v->far && isfinite(v->near));
    assert_true(directional ? isfinite(v->far) && fov == 0 : v->near > 0 && fov > 0 && fov <= 120 + 1e-9);
}

/* Farther than 8192 scene radii, rays are as good as parallel. */
static bool shines_in_parallel(const struct scene *scene, const struct light *light)
{
    double away = dvec3_length(dvec3_sub(light->position, dbox_center(&scene->bounds)));
    return light->kind == LIGHT_DIRECTIONAL || away > 8192 * dbox_radius(&scene->bounds);
}

static void fit(struct setting *c, const struct light *light, bool cube)
{
    shadow_fit_compute(&c->geometry, light, SIZE, cube, c->casters, &c->fit);
    assert_true(c->fit.map_count <= SHADOW_MAPS_MAX);
    assert_true(c->fit.caster_count <= c->scene->instance_count);
    assert_true(c->fit.caster_count > 0 || c->fit.map_count == 0);
    for (size_t i = 1; i < c->fit.caster_count; i++)
        assert_true(c->fit.casters[i] > c->fit.casters[i - 1]);
    for (unsigned i = 0; i < c->fit.map_count; i++)
        check_view(&c->fit.maps[i], c->fit.fov_deg[i], shines_in_parallel(c->scene, light));
}

static bool in_some_map(const struct shadow_fit *fit, struct dvec3 p)
{
    for (unsigned i = 0; i < fit->map_count; i++) {
        double x, y, depth;
        if (view_project(&fit->maps[i], p, &x, &y, &depth) && x >= 0 && x <= SIZE && y >= 0 && y <= SIZE &&
            depth <= fit->maps[i].far)
            return true;
    }
    return false;
}

/* Whether the light reaches there at all: inside its cone. */
static bool matters(const struct light *light, struct dvec3 p)
{
    struct dvec3 d = dvec3_sub(p, light->position);
    double length = dvec3_length(d);
    if (length == 0)
        return false;
    return light->kind != LIGHT_SPOT || dvec3_dot(d, light->direction) / length > cos(light->outer) + 1e-9;
}

static bool can_cast(const struct scene *scene, const struct instance *instance, uint32_t triangle)
{
    struct dvec3 a = instance_vertex(scene, instance, triangle, 0);
    struct dvec3 e = dvec3_sub(instance_vertex(scene, instance, triangle, 1), a);
    struct dvec3 f = dvec3_sub(instance_vertex(scene, instance, triangle, 2), a);
    return dvec3_length(dvec3_cross(e, f)) > 0; /* not a number: false */
}

/* Every vertex of every caster projects into some map. */
static void check_vertices(const struct setting *c, const struct light *light, const char *name)
{
    size_t checked = 0;
    for (size_t k = 0; k < c->fit.caster_count; k++) {
        const struct instance *instance = &c->scene->instances[c->fit.casters[k]];
        uint32_t triangles = c->scene->meshes[instance->mesh].index_count / 3;
        for (uint32_t t = 0; t < triangles; t++)
            for (unsigned corner = 0; corner < 3 && can_cast(c->scene, instance, t); corner++) {
                struct dvec3 p = instance_vertex(c->scene, instance, t, corner);
                if (!matters(light, p))
                    continue;
                checked++;
                if (!in_some_map(&c->fit, p))
                    fail_msg("%s, light kind %d at %g %g %g: a vertex at %g %g %g is in none of %u maps", name, (int)light->kind,
                             light->position.x, light->position.y, light->position.z, p.x, p.y, p.z, c->fit.map_count);
            }
    }
    if (light->kind != LIGHT_SPOT)
        assert_true(checked > 0);
}

static void check_lights(struct setting *c, const char *name)
{
    struct dvec3 middle = dbox_center(&c->scene->bounds);
    double radius = dbox_radius(&c->scene->bounds);
    static const double places[][3] = {{0, 3, 0},      {1, 2, 1},      {-2, 0.5, 0.3}, {0.1, 0.1, 0.05}, {0, -2, 0.2}, {0, 0, 0},
                                       {0.4, 0, -0.2}, {3000, 1e4, 0}, {3000, 7e3, 0}, {0, 1e-3, 1},     {0, 0.7, 0}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
        for (int kind = 0; kind < 3; kind++)
            for (int cube = 0; cube < 2; cube++) {
                struct dvec3 at = dvec3_mad(middle, dvec3(places[i][0], places[i][1], places[i][2]), radius);
                struct light light = made_light((enum light_kind)kind, at, middle);
                if (dvec3_length(light.direction) == 0)
                    light.direction = dvec3(0.6, -0.8, 0);
                light.outer = i % 2 ? 0.3 : 1.4;
                fit(c, &light, cube);
                check_vertices(c, &light, name);
            }
}

static void test_every_caster_vertex_is_in_a_map(void **state)
{
    (void)state;
    static const char *const scenes[] = {"builtin:box",
                                         "builtin:ball:frequency=2",
                                         "builtin:tree:leaves=500",
                                         "builtin:dragon:triangles=5000",
                                         "builtin:hard-04-contact",
                                         "builtin:hard-11-degenerate",
                                         "builtin:hard-20-twosided",
                                         "builtin:hard-21-grid"};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        struct setting c = setting_load(scenes[i]);
        check_lights(&c, scenes[i]);
        setting_close(&c);
    }
}

static void add_cube(struct scene *scene, struct dvec3 center, double half)
{
    float points[8][3];
    for (int i = 0; i < 8; i++) {
        points[i][0] = (float)(center.x + (i & 1 ? half : -half));
        points[i][1] = (float)(center.y + (i & 2 ? half : -half));
        points[i][2] = (float)(center.z + (i & 4 ? half : -half));
    }
    static const uint32_t indices[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                         2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    made_instance(scene, made_mesh(scene, points, NULL, 8, indices, 36, 0), affine_identity());
}

static void add_floor(struct scene *scene, double y, double half)
{
    const float h = (float)half, f = (float)y;
    const float points[6][3] = {{-h, f, -h}, {-h, f, h}, {h, f, h}, {-h, f, -h}, {h, f, h}, {h, f, -h}};
    made_triangles(scene, points, 6, 0);
}

static struct scene *start(void)
{
    struct scene *scene = made_scene();
    made_material(scene, true);
    return scene;
}

/* A unit cube on a wide floor: instance 0 is the floor. */
static struct setting cube_on_floor(void)
{
    struct scene *scene = start();
    add_floor(scene, 0, 100);
    add_cube(scene, dvec3(0, 0.5, 0), 0.5);
    made_finish(scene);
    return setting_open(scene);
}

static void test_a_floor_with_all_above_casts_nothing(void **state)
{
    (void)state;
    struct setting c = cube_on_floor();
    const struct light lights[] = {made_light(LIGHT_POINT, dvec3(1, 5, 1), dvec3(0, 0, 0)),
                                   made_light(LIGHT_SPOT, dvec3(1, 5, 1), dvec3(0, 0, 0)),
                                   made_light(LIGHT_DIRECTIONAL, dvec3(0, 5, 1), dvec3(0, 0, 0))};
    for (size_t i = 0; i < 3; i++) {
        fit(&c, &lights[i], false);
        assert_int_equal(c.fit.caster_count, 1);
        assert_int_equal(c.fit.casters[0], 1);
        assert_int_equal(c.fit.map_count, 1);
        /* Nor does it widen the map: the cube's diagonal is 1.8. */
        const struct view *v = &c.fit.maps[0];
        assert_true(v->right_edge - v->left < 1.9 && v->top - v->bottom < 1.9);
        assert_true(i == 2 || (c.fit.fov_deg[0] > 5 && c.fit.fov_deg[0] < 30));
    }
    setting_close(&c);
}

static void test_a_floor_casts_when_the_light_is_below(void **state)
{
    (void)state;
    struct setting c = cube_on_floor();
    const struct light lights[] = {made_light(LIGHT_POINT, dvec3(1, -5, 1), dvec3(0, 0, 0)),
                                   made_light(LIGHT_DIRECTIONAL, dvec3(0, -5, 1), dvec3(0, 0, 0))};
    for (size_t i = 0; i < sizeof lights / sizeof lights[0]; i++) {
        fit(&c, &lights[i], false);
        assert_int_equal(c.fit.caster_count, 2);
        check_vertices(&c, &lights[i], "cube on floor");
    }
    setting_close(&c);
}

static void test_a_floor_seen_edge_on_casts_nothing(void **state)
{
    (void)state;
    struct setting c = cube_on_floor();
    const struct light lights[] = {made_light(LIGHT_POINT, dvec3(3, 0, 1), dvec3(0, 0, 0)),
                                   made_light(LIGHT_DIRECTIONAL, dvec3(1, 0, 0), dvec3(0, 0, 0))};
    for (size_t i = 0; i < sizeof lights / sizeof lights[0]; i++) {
        fit(&c, &lights[i], false);
        assert_int_equal(c.fit.caster_count, 1);
        assert_int_equal(c.fit.map_count, 1);
    }
    setting_close(&c);
}

static void test_a_floor_with_something_below_casts(void **state)
{
    (void)state;
    struct scene *scene = start();
    add_floor(scene, 0, 10);
    add_cube(scene, dvec3(0, 0.5, 0), 0.5);
    add_cube(scene, dvec3(0, -2, 0), 0.5);
    made_finish(scene);
    struct setting c = setting_open(scene);
    struct light light = made_light(LIGHT_POINT, dvec3(1, 5, 1), dvec3(0, 0, 0));
    fit(&c, &light, false);
    assert_int_equal(c.fit.caster_count, 3);
    setting_close(&c);
}

/* 120 degrees: from a cube of half side 1, at distance d of its near face, a corner is seen at atan(sqrt(2) / d). */
static void test_point_light_within_120_degrees_has_one_map(void **state)
{
    (void)state;
    struct scene *scene = start();
    add_cube(scene, dvec3(0, 0, 0), 1);
    made_finish(scene);
    struct setting c = setting_open(scene);
    double limit = 1 + sqrt(2) / tan(M_PI / 3);
    struct light light = made_light(LIGHT_POINT, dvec3(0, limit * 1.03, 0), dvec3(0, 0, 0));
    fit(&c, &light, false);
    assert_int_equal(c.fit.map_count, 1);
    assert_true(c.fit.fov_deg[0] > 90 && c.fit.fov_deg[0] <= 120);
    light.position.y = limit * 0.97;
    fit(&c, &light, false);
    /* Faces: down, and four sides that the cube's top just does not reach when it is seen at less than 45 degrees. */
    assert_true(c.fit.map_count > 1 && c.fit.map_count < 6);
    for (unsigned i = 0; i < c.fit.map_count; i++)
        assert_true(c.fit.fov_deg[i] == 90 && c.fit.maps[i].forward.y < 0.5);
    light.position.y = 100;
    fit(&c, &light, false);
    assert_true(c.fit.map_count == 1 && c.fit.fov_deg[0] < 2);
    setting_close(&c);
}

/* A round caster near the light: boxes around its vertices reach far beyond it. Its radius with the wires is 1.01, its foot on the floor. */
static void test_120_degrees_are_those_of_the_vertices(void **state)
{
    (void)state;
    struct setting c = setting_load("builtin:ball");
    struct light light = made_light(LIGHT_POINT, dvec3(0, 2.2, 0), dvec3(0, 0, 0));
    fit(&c, &light, false);
    assert_int_equal(c.fit.map_count, 1);
    assert_true(fabs(c.fit.fov_deg[0] - 2 * 58.07) < 1);
    check_vertices(&c, &light, "near the ball");
    light.position.y = 2.15;
    fit(&c, &light, false);
    assert_int_equal(c.fit.map_count, 5);
    setting_close(&c);
}

static void test_faces_without_casters_have_no_map(void **state)
{
    (void)state;
    struct scene *scene = start();
    add_cube(scene, dvec3(5, 0, 0), 0.5);
    add_cube(scene, dvec3(-5, 0, 0), 0.5);
    add_cube(scene, dvec3(0, 5, 0), 0.5);
    made_finish(scene);
    struct setting c = setting_open(scene);
    struct light light = made_light(LIGHT_POINT, dvec3(0, 0, 0), dvec3(1, 0, 0));
    fit(&c, &light, false);
    assert_int_equal(c.fit.map_count, 3);
    for (unsigned i = 0; i < 3; i++) {
        struct dvec3 f = c.fit.maps[i].forward;
        assert_true(fabs(f.x) == 1 || f.y == 1);
        assert_true(fabs(c.fit.maps[i].near - 4.5) < 0.01);
    }
    /* A spot wider than a map may be has one all the same where its cone holds little. */
    light = made_light(LIGHT_SPOT, dvec3(0, 0, 0), dvec3(1, 0, 0));
    light.outer = 1.2;
    fit(&c, &light, false);
    assert_int_equal(c.fit.caster_count, 1);
    assert_int_equal(c.fit.map_count, 1);
    assert_true(c.fit.fov_deg[0] < 15);
    setting_close(&c);
}

static void test_light_inside_the_scene(void **state)
{
    (void)state;
    struct setting c = setting_load("builtin:ball:frequency=2");
    struct light light = made_light(LIGHT_POINT, dbox_center(&c.scene->bounds), dvec3(0, 0, 0));
    fit(&c, &light, false);
    assert_int_equal(c.fit.map_count, 6);
    check_vertices(&c, &light, "inside the ball");
    setting_close(&c);
}

static void test_spot_takes_what_its_cone_holds(void **state)
{
    (void)state;
    struct scene *scene = start();
    add_cube(scene, dvec3(0, 0, 0), 0.5);
    add_cube(scene, dvec3(6, 0, 0), 0.5);
    add_cube(scene, dvec3(0, 20, 0), 0.5);
    made_finish(scene);
    struct setting c = setting_open(scene);
    struct light light = made_light(LIGHT_SPOT, dvec3(0, 5, 0), dvec3(0, 0, 0));
    light.inner = 0;
    light.outer = 0.3;
    fit(&c, &light, false);
    assert_int_equal(c.fit.caster_count, 1);
    assert_int_equal(c.fit.map_count, 1);
    double narrow = c.fit.fov_deg[0];
    assert_true(narrow > 5 && narrow < 17);
    /* The inner angle changes brightness only. */
    light.inner = 0.29;
    fit(&c, &light, false);
    assert_true(c.fit.fov_deg[0] == narrow);
    /* A cone narrower than the caster bounds the map. */
    light.inner = 0;
    light.outer = 0.02;
    fit(&c, &light, false);
    assert_true(fabs(c.fit.fov_deg[0] - 0.04 * 180 / M_PI) < 0.01);
    light.outer = 1;
    fit(&c, &light, false);
    assert_int_equal(c.fit.caster_count, 2);
    assert_int_equal(c.fit.map_count, 1);
    check_vertices(&c, &light, "a wide spot");
    light.direction = dvec3(0, 0, 1);
    light.outer = 0.3;
    fit(&c, &light, false);
    assert_int_equal(c.fit.map_count, 0);
    setting_close(&c);
}

static void test_casters_beyond_the_range_do_not_count(void **state)
{
    (void)state;
    struct scene *scene = start();
    add_cube(scene, dvec3(0, 0, 0), 0.5);
    add_cube(scene, dvec3(0, -50, 0), 0.5);
    made_finish(scene);
    struct setting c = setting_open(scene);
    struct light light = made_light(LIGHT_POINT, dvec3(0.2, 5, 0), dvec3(0, 0, 0));
    fit(&c, &light, false);
    assert_int_equal(c.fit.caster_count, 2);
    light.range = 10;
    fit(&c, &light, false);
    assert_int_equal(c.fit.caster_count, 1);
    light.range = 1;
    fit(&c, &light, false);
    assert_int_equal(c.fit.map_count, 0);
    setting_close(&c);
}

static void test_cube_fit(void **state)
{
    (void)state;
    struct setting c = setting_load("builtin:box");
    struct light light = made_light(LIGHT_POINT, dvec3(0, 40, 1), dvec3(0, 0, 0));
    fit(&c, &light, true);
    assert_int_equal(c.fit.map_count, 1);
    assert_true(c.fit.fov_deg[0] == 90 && c.fit.maps[0].forward.y == -1);
    check_vertices(&c, &light, "box");
    light = made_light(LIGHT_DIRECTIONAL, dvec3(1, 3, 1), dvec3(0, 0, 0));
    fit(&c, &light, true);
    const struct view *v = &c.fit.maps[0];
    double radius = dbox_radius(&c.scene->bounds);
    assert_true(fabs(v->right_edge - v->left - 2 * radius) < 1e-3 * radius);
    assert_true(fabs((v->right_edge - v->left) - (v->top - v->bottom)) < 1e-9 * radius);
    setting_close(&c);
}

/* The camera has no part in it, and the same question has the same answer. */
static void test_same_light_same_bits(void **state)
{
    (void)state;
    struct setting c = setting_load("builtin:dragon:triangles=5000");
    struct light light = made_light(LIGHT_POINT, dvec3(1, 4, 2), dvec3(0, 0, 0));
    fit(&c, &light, false);
    struct shadow_fit first = c.fit;
    fit(&c, &light, false);
    assert_memory_equal(first.maps, c.fit.maps, sizeof first.maps);
    assert_memory_equal(first.fov_deg, c.fit.fov_deg, sizeof first.fov_deg);
    setting_close(&c);
}

/* Casters in one plane across the light's way: near and far keep a distance that single precision can tell apart. */
static void test_flat_casters_have_depth(void **state)
{
    (void)state;
    struct scene *scene = start();
    add_floor(scene, 0, 2);
    add_floor(scene, 1, 1);
    made_finish(scene);
    struct setting c = setting_open(scene);
    struct light light = made_light(LIGHT_DIRECTIONAL, dvec3(0, 1, 0), dvec3(0, 0, 0));
    fit(&c, &light, false);
    assert_int_equal(c.fit.map_count, 1);
    const struct view *v = &c.fit.maps[0];
    double most = fmax(fabs(v->near), fabs(v->far));
    assert_true(v->far - v->near > 16 * (double)nextafterf((float)most, INFINITY) - 16 * most);
    assert_true(v->far - v->near > 1e-6 * most);
    setting_close(&c);
}

static void test_degenerate_scenes(void **state)
{
    (void)state;
    static const enum light_kind kinds[] = {LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPOT};
    struct scene *empty = start();
    made_finish(empty);
    struct setting none = setting_open(empty);
    struct scene *scene = start();
    const float triangle[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    made_triangles(scene, triangle, 3, 0);
    made_finish(scene);
    struct setting one = setting_open(scene);
    struct scene *bad = start();
    const float nowhere[3][3] = {{NAN, 0, 0}, {1, INFINITY, 0}, {0, 1, 0}};
    made_triangles(bad, nowhere, 3, 0);
    made_finish(bad);
    struct setting nan = setting_open(bad);
    for (int k = 0; k < 3; k++)
        for (int cube = 0; cube < 2; cube++) {
            struct light light = made_light(kinds[k], dvec3(0.1, 0.2, 3), dvec3(0, 0, 0));
            fit(&none, &light, cube);
            assert_int_equal(none.fit.map_count, 0);
            /* Alone in the world, a plane has nothing to cast on. */
            fit(&one, &light, cube);
            assert_int_equal(one.fit.map_count, 0);
            fit(&nan, &light, cube);
            assert_int_equal(nan.fit.map_count, 0);
        }
    setting_close(&none);
    setting_close(&one);
    setting_close(&nan);
}

/* A light exactly in a vertex, on an edge, on a face, and casters of no extent. */
static void test_lights_that_touch(void **state)
{
    (void)state;
    struct scene *scene = start();
    add_cube(scene, dvec3(0, 0, 0), 1);
    const float point[3][3] = {{3, 0, 0}, {3, 0, 0}, {3, 0, 0}};
    made_triangles(scene, point, 3, 0);
    made_finish(scene);
    struct setting c = setting_open(scene);
    static const double places[][3] = {{1, 1, 1}, {1, 1, 0.3}, {0.2, 1, 0.3}, {0, 0, 0}, {1, 1 + 1e-12, 1}, {3, 0, 0}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
        for (int kind = LIGHT_POINT; kind <= LIGHT_SPOT; kind++)
            for (int cube = 0; cube < 2; cube++) {
                struct light light =
                    made_light((enum light_kind)kind, dvec3(places[i][0], places[i][1], places[i][2]), dvec3(0, -5, 0.5));
                fit(&c, &light, cube);
                check_vertices(&c, &light, "a touching light");
            }
    setting_close(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_caster_vertex_is_in_a_map),
        cmocka_unit_test(test_a_floor_with_all_above_casts_nothing),
        cmocka_unit_test(test_a_floor_casts_when_the_light_is_below),
        cmocka_unit_test(test_a_floor_seen_edge_on_casts_nothing),
        cmocka_unit_test(test_a_floor_with_something_below_casts),
        cmocka_unit_test(test_point_light_within_120_degrees_has_one_map),
        cmocka_unit_test(test_120_degrees_are_those_of_the_vertices),
        cmocka_unit_test(test_faces_without_casters_have_no_map),
        cmocka_unit_test(test_light_inside_the_scene),
        cmocka_unit_test(test_spot_takes_what_its_cone_holds),
        cmocka_unit_test(test_casters_beyond_the_range_do_not_count),
        cmocka_unit_test(test_cube_fit),
        cmocka_unit_test(test_same_light_same_bits),
        cmocka_unit_test(test_flat_casters_have_depth),
        cmocka_unit_test(test_degenerate_scenes),
        cmocka_unit_test(test_lights_that_touch),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
