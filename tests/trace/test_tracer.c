#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "made_scene.h"
#include "scene/pixel.h"
#include "trace/tracer.h"

enum { WIDTH = 37, HEIGHT = 23 };

static const float square[4][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
static const float square_uv[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
static const uint32_t square_indices[6] = {0, 1, 2, 0, 2, 3};

static struct affine at_z(double z, double scale)
{
    struct affine a = affine_identity();
    a.linear[0][0] = a.linear[1][1] = a.linear[2][2] = scale;
    a.offset[2] = z;
    return a;
}

/* One picture of a scene, and what made it. */
struct shot {
    struct job_pool *pool;
    struct tracer *tracer;
    struct view view;
    uint32_t ids[WIDTH * HEIGHT];
    struct pixel pixels[WIDTH * HEIGHT];
};

static struct shot *shoot(struct scene *scene, struct camera camera)
{
    struct error err = {0};
    struct shot *s = calloc(1, sizeof *s);
    assert_non_null(s);
    s->pool = job_pool_create(2, &err);
    s->tracer = tracer_create(scene, 2, &err);
    assert_non_null(s->tracer);
    assert_true(tracer_bytes(s->tracer) > 0);
    s->view = view_from_camera(&camera, WIDTH, HEIGHT);
    tracer_camera(s->tracer, &s->view, s->pool, s->ids, s->pixels);
    return s;
}

static void finish(struct shot *s, struct scene *scene)
{
    tracer_destroy(s->tracer);
    job_pool_destroy(s->pool);
    free(s);
    scene_destroy(scene);
}

static uint32_t middle(const struct shot *s) { return s->ids[HEIGHT / 2 * WIDTH + WIDTH / 2 + 1]; }

static struct scene *square_scene(bool double_sided, double mirror)
{
    struct scene *scene = made_scene();
    uint32_t mesh = made_mesh(scene, square, square_uv, 4, square_indices, 6, made_material(scene, double_sided));
    struct affine near = at_z(0, 1);
    near.linear[0][0] *= mirror;
    made_instance(scene, mesh, near);
    made_instance(scene, mesh, at_z(-2, 4));
    return scene;
}

static void ids_run_on_over_instances(void **state)
{
    (void)state;
    struct scene *scene = square_scene(false, 1);
    made_finish(scene);
    struct shot *s = shoot(scene, made_camera(dvec3(0, 0, 6), dvec3(0, 0, 0), 0.7));
    size_t seen[4] = {0};
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        if (s->ids[i] != SCENE_NONE) {
            assert_true(s->ids[i] < 4);
            seen[s->ids[i]]++;
        }
    for (int i = 0; i < 4; i++)
        assert_true(seen[i] > 20);
    finish(s, scene);
}

static void depth_and_normal_are_the_planes(void **state)
{
    (void)state;
    struct scene *scene = square_scene(false, 1);
    made_finish(scene);
    struct shot *s = shoot(scene, made_camera(dvec3(1, 0.5, 6), dvec3(0, 0, 0), 0.7));
    size_t checked = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        float r[3];
        if (s->ids[i] == SCENE_NONE) {
            static const struct pixel nothing;
            assert_memory_equal(&s->pixels[i], &nothing, sizeof nothing);
            continue;
        }
        pixel_geometric(&s->pixels[i], r);
        struct dvec3 origin, direction;
        view_ray(&s->view, (double)(i % WIDTH) + 0.5, (double)(i / WIDTH) + 0.5, &origin, &direction);
        struct dvec3 p = dvec3_mad(origin, direction, s->pixels[i].depth);
        assert_true(fabs(p.z - (s->ids[i] < 2 ? 0 : -2)) < 4e-6);
        assert_true(fabs(r[2] - 1) < 1e-6 && fabs(r[0]) < 1e-6 && fabs(r[1]) < 1e-6);
        checked++;
    }
    assert_true(checked > 100);
    finish(s, scene);
}

static void back_faces_are_hidden_unless_double_sided(void **state)
{
    (void)state;
    static const struct {
        bool double_sided;
        double mirror;
        double eye_z;
        bool near_seen;
    } cases[] = {{false, 1, 6, true}, {false, 1, -6, false}, {true, 1, -6, true}, {false, -1, 6, true}, {false, -1, -6, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct scene *scene = made_scene();
        uint32_t mesh = made_mesh(scene, square, NULL, 4, square_indices, 6, made_material(scene, cases[i].double_sided));
        struct affine a = at_z(0, 1);
        a.linear[0][0] = cases[i].mirror;
        made_instance(scene, mesh, a);
        /* A wall seen from both sides behind it, so that passing through is told from missing. */
        uint32_t wall = made_mesh(scene, square, NULL, 4, square_indices, 6, made_material(scene, true));
        made_instance(scene, wall, at_z(cases[i].eye_z > 0 ? -1 : 1, 8));
        made_finish(scene);
        struct shot *s = shoot(scene, made_camera(dvec3(0.1, 0.05, cases[i].eye_z), dvec3(0, 0, 0), 0.7));
        assert_true(middle(s) != SCENE_NONE);
        assert_int_equal(middle(s) < 2, cases[i].near_seen);
        finish(s, scene);
    }
}

static void holes_let_rays_through(void **state)
{
    (void)state;
    static const uint8_t solid[4] = {1, 0, 1, 0};
    struct scene *scene = square_scene(true, 1);
    made_mask(scene, 0, 2, solid);
    /* The wall behind keeps a material without holes. */
    scene->meshes = realloc(scene->meshes, 2 * sizeof *scene->meshes);
    scene->meshes[1] = scene->meshes[0];
    scene->mesh_count = 2;
    scene->meshes[1].material = made_material(scene, true);
    scene->instances[1].mesh = 1;
    made_finish(scene);
    struct shot *s = shoot(scene, made_camera(dvec3(0, 0, 6), dvec3(0, 0, 0), 0.7));
    uint32_t row = HEIGHT / 2 * WIDTH;
    assert_true(s->ids[row + WIDTH / 2 - 2] < 2);
    assert_true(s->ids[row + WIDTH / 2 + 2] >= 2 && s->ids[row + WIDTH / 2 + 2] < 4);
    finish(s, scene);
}

static void broken_vertices_break_nothing(void **state)
{
    (void)state;
    struct scene *scene = made_scene();
    float points[][3] = {{-1, -1, 0}, {1, -1, 0},       {0, NAN, 0},   {-9, -9, -3},   {9, -9, -3},
                         {0, 9, -3},  {INFINITY, 0, 1}, {0, 1, 1},     {1, 0, 1},      {0, 0, 2},
                         {0, 0, 2},   {0, 0, 2},        {3e38f, 0, 3}, {0, -3e38f, 3}, {1, 1, 3}};
    made_triangles(scene, (const float(*)[3])points, 15, made_material(scene, true));
    made_finish(scene);
    struct shot *s = shoot(scene, made_camera(dvec3(0, 0, 6), dvec3(0, 0, 0), 0.3));
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        assert_int_equal(s->ids[i], 1);
    finish(s, scene);
}

static void an_empty_scene_shows_nothing(void **state)
{
    (void)state;
    struct scene *scene = made_scene();
    made_finish(scene);
    struct shot *s = shoot(scene, made_camera(dvec3(0, 0, 6), dvec3(0, 0, 0), 0.3));
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        assert_int_equal(s->ids[i], SCENE_NONE);
    finish(s, scene);
}

static void near_and_far_cut(void **state)
{
    (void)state;
    for (int orthographic = 0; orthographic < 2; orthographic++) {
        struct scene *scene = square_scene(true, 1);
        made_finish(scene);
        struct camera camera = made_camera(dvec3(0.1, 0.05, 6), dvec3(0.1, 0.05, 0), 0.3);
        camera.orthographic = orthographic;
        camera.near = 6.5;
        camera.far = 9;
        struct shot *s = shoot(scene, camera);
        assert_true(middle(s) >= 2 && middle(s) < 4);
        assert_true(fabs(s->pixels[HEIGHT / 2 * WIDTH + WIDTH / 2 + 1].depth - 8) < 4e-6);
        s->view.far = 7;
        tracer_camera(s->tracer, &s->view, s->pool, s->ids, NULL);
        assert_int_equal(middle(s), SCENE_NONE);
        finish(s, scene);
    }
}

static void a_light_sees_its_casters_from_both_sides(void **state)
{
    (void)state;
    struct scene *scene = square_scene(false, -1);
    made_finish(scene);
    struct shot *s = shoot(scene, made_camera(dvec3(0.1, 0.05, 6), dvec3(0.1, 0.05, 0), 0.3));
    s->view.orthographic = true;
    s->view.left = s->view.bottom = -1;
    s->view.right_edge = s->view.top = 1;
    s->view.near = -20;
    s->view.far = 30;
    float depths[WIDTH * HEIGHT];
    size_t at = HEIGHT / 2 * WIDTH + WIDTH / 2 + 1;
    tracer_light(s->tracer, &s->view, NULL, 0, s->pool, depths, s->ids);
    assert_true(fabsf(depths[at] - 6) < 4e-6f && s->ids[at] < 2);
    const uint32_t wall = 1;
    for (int again = 0; again < 2; again++) {
        tracer_light(s->tracer, &s->view, &wall, 1, s->pool, depths, s->ids);
        assert_true(fabsf(depths[at] - 8) < 4e-6f && s->ids[at] >= 2);
    }
    tracer_light(s->tracer, &s->view, &wall, 0, s->pool, depths, NULL);
    assert_true(isinf(depths[at]));
    finish(s, scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ids_run_on_over_instances),
        cmocka_unit_test(depth_and_normal_are_the_planes),
        cmocka_unit_test(back_faces_are_hidden_unless_double_sided),
        cmocka_unit_test(holes_let_rays_through),
        cmocka_unit_test(broken_vertices_break_nothing),
        cmocka_unit_test(an_empty_scene_shows_nothing),
        cmocka_unit_test(near_and_far_cut),
        cmocka_unit_test(a_light_sees_its_casters_from_both_sides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
