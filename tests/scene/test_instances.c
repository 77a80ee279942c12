/* Instances, drawn-triangle ids, bounds, and that where a scene lies in the world changes no bit of it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "made_scene.h"

static const float quad[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
static const uint32_t quad_indices[6] = {0, 1, 2, 0, 2, 3};

static struct affine at(double x, double y, double z)
{
    struct affine a = affine_identity();
    a.offset[0] = x;
    a.offset[1] = y;
    a.offset[2] = z;
    return a;
}

static void ids_run_on_over_instances(void **state)
{
    (void)state;
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, false);
    uint32_t two = made_mesh(scene, quad, NULL, 4, quad_indices, 6, material);
    uint32_t none = made_mesh(scene, quad, NULL, 4, quad_indices, 0, material);
    uint32_t one = made_mesh(scene, quad, NULL, 4, quad_indices, 3, material);
    const uint32_t order[] = {none, two, none, none, one, two, none};
    for (size_t i = 0; i < 7; i++)
        made_instance(scene, order[i], at((double)i, 0, 0));
    made_finish(scene);
    assert_int_equal(scene->triangle_count, 3);
    assert_int_equal(scene->drawn_triangle_count, 5);
    const uint32_t owner[] = {1, 1, 4, 5, 5};
    for (uint32_t id = 0; id < 5; id++) {
        assert_int_equal(scene_instance_of(scene, id), owner[id]);
        assert_true(scene->instances[owner[id]].first_triangle <= id);
    }
    assert_true(dbox_is_empty(&scene->instances[0].bounds));
    assert_true(scene->meshes[none].bounds_min[0] > scene->meshes[none].bounds_max[0]);
    scene_destroy(scene);
}

static void mirrored_and_bounded(void **state)
{
    (void)state;
    struct scene *scene = made_scene();
    uint32_t mesh = made_mesh(scene, quad, NULL, 4, quad_indices, 6, made_material(scene, false));
    struct affine flip = at(10, 0, 0);
    flip.linear[0][0] = -2;
    made_instance(scene, mesh, affine_identity());
    made_instance(scene, mesh, flip);
    made_finish(scene);
    assert_false(scene->instances[0].mirrored);
    assert_true(scene->instances[1].mirrored);
    assert_true(scene->instances[1].bounds.min.x == 8 && scene->instances[1].bounds.max.x == 10);
    assert_true(scene->bounds.min.x == 0 && scene->bounds.max.x == 10 && scene->bounds.max.y == 1);
    struct dvec3 v = instance_vertex(scene, &scene->instances[1], 1, 1);
    assert_true(v.x == 8 && v.y == 1 && v.z == 0);
    scene_destroy(scene);
}

/* Only what a triangle uses and what is finite counts. */
static void bounds_pass_over_the_rest(void **state)
{
    (void)state;
    const float points[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {100, 0, 0}, {NAN, INFINITY, 0}};
    const uint32_t indices[6] = {0, 1, 2, 0, 1, 4};
    struct scene *scene = made_scene();
    uint32_t mesh = made_mesh(scene, points, NULL, 5, indices, 6, made_material(scene, false));
    made_instance(scene, mesh, affine_identity());
    made_finish(scene);
    assert_true(scene->bounds.max.x == 1 && scene->bounds.max.y == 1);
    assert_true(scene->meshes[mesh].bounds_max[0] == 1);
    scene_destroy(scene);
}

static struct scene *two_quads(double away)
{
    struct scene *scene = made_scene();
    uint32_t mesh = made_mesh(scene, quad, NULL, 4, quad_indices, 6, made_material(scene, false));
    struct affine second = at(away + 0.5, 0.25, -3);
    second.linear[1][2] = 0.3;
    made_instance(scene, mesh, at(away, 0, 0));
    made_instance(scene, mesh, second);
    scene->lights = calloc(1, sizeof *scene->lights);
    scene->cameras = calloc(1, sizeof *scene->cameras);
    assert_true(scene->lights && scene->cameras);
    scene->light_count = scene->camera_count = 1;
    scene->lights[0] = made_light(LIGHT_POINT, dvec3(away + 2, 5, 1), dvec3(away, 0, 0));
    scene->cameras[0] = made_camera(dvec3(away, 1, 4), dvec3(away, 0, 0), 0.8);
    made_finish(scene);
    return scene;
}

static void moved_as_a_whole_is_the_same(void **state)
{
    (void)state;
    struct scene *here = two_quads(0);
    const double far_out[] = {1e3, 1e6, 1e7, -1048576};
    for (size_t i = 0; i < 4; i++) {
        struct scene *there = two_quads(far_out[i]);
        assert_true(there->origin.x == far_out[i]);
        assert_int_equal(here->hash, there->hash);
        assert_memory_equal(&here->bounds, &there->bounds, sizeof here->bounds);
        assert_memory_equal(&here->lights[0].position, &there->lights[0].position, sizeof(struct dvec3));
        assert_memory_equal(&here->cameras[0].eye, &there->cameras[0].eye, sizeof(struct dvec3));
        for (uint32_t id = 0; id < 4; id++) {
            struct dvec3 a = instance_vertex(here, &here->instances[id / 2], id % 2, 2);
            struct dvec3 b = instance_vertex(there, &there->instances[id / 2], id % 2, 2);
            assert_memory_equal(&a, &b, sizeof a);
        }
        scene_destroy(there);
    }
    scene_destroy(here);
}

static void hash_sees_what_a_picture_depends_on(void **state)
{
    (void)state;
    struct scene *a = two_quads(0), *b = two_quads(0);
    assert_int_equal(a->hash, b->hash);
    scene_destroy(b);
    b = made_scene();
    uint32_t mesh = made_mesh(b, quad, NULL, 4, quad_indices, 6, made_material(b, true));
    made_instance(b, mesh, affine_identity());
    struct scene *c = made_scene();
    mesh = made_mesh(c, quad, NULL, 4, quad_indices, 6, made_material(c, false));
    made_instance(c, mesh, affine_identity());
    made_finish(b);
    made_finish(c);
    assert_int_not_equal(b->hash, c->hash);
    scene_destroy(a);
    scene_destroy(b);
    scene_destroy(c);
}

static void too_many_triangles_are_refused(void **state)
{
    (void)state;
    struct scene *scene = made_scene();
    /* 2^22 triangles, 2^10 times. */
    const uint32_t indices = 3u << 22;
    uint32_t *many = calloc(indices, sizeof *many);
    assert_non_null(many);
    uint32_t mesh = made_mesh(scene, quad, NULL, 4, many, indices, made_material(scene, false));
    free(many);
    for (int i = 0; i < 1024; i++)
        made_instance(scene, mesh, affine_identity());
    struct error err = {0};
    assert_false(scene_finish(scene, &err));
    assert_int_equal(err.code, ERROR_DATA);
    scene_destroy(scene);
    scene_destroy(NULL);
}

static void defaults_frame_the_scene(void **state)
{
    (void)state;
    struct scene *scene = two_quads(0), *empty = made_scene();
    made_finish(empty);
    const double aspects[] = {2, 1, 0.25};
    for (size_t i = 0; i < 3; i++) {
        struct camera c = scene_default_camera(scene, aspects[i]);
        struct view v = view_from_camera(&c, (uint32_t)(400 * aspects[i]), 400);
        for (int k = 0; k < 8; k++) {
            const struct dbox *b = &scene->bounds;
            double x, y, depth;
            struct dvec3 p = dvec3(k & 1 ? b->max.x : b->min.x, k & 2 ? b->max.y : b->min.y, k & 4 ? b->max.z : b->min.z);
            assert_true(view_project(&v, p, &x, &y, &depth));
            assert_true(x >= 0 && x <= v.width && y >= 0 && y <= v.height && depth > c.near);
        }
    }
    struct camera c = scene_default_camera(empty, 1);
    assert_true(dvec3_finite(c.eye) && c.near > 0);
    struct light l = scene_default_light(scene);
    assert_true(l.kind == LIGHT_DIRECTIONAL && fabs(dvec3_length(l.direction) - 1) < 1e-12 && l.direction.y < 0);
    scene_destroy(scene);
    scene_destroy(empty);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ids_run_on_over_instances),
        cmocka_unit_test(mirrored_and_bounded),
        cmocka_unit_test(bounds_pass_over_the_rest),
        cmocka_unit_test(moved_as_a_whole_is_the_same),
        cmocka_unit_test(hash_sees_what_a_picture_depends_on),
        cmocka_unit_test(too_many_triangles_are_refused),
        cmocka_unit_test(defaults_frame_the_scene),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
