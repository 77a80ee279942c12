#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "cameras.h"

static struct camera cameras[] = {{.name = "front", .yfov = 1}, {.name = "side", .yfov = 0.5}, {.name = "0", .yfov = 0.25}};
static const struct scene with_cameras = {.cameras = cameras, .camera_count = 3, .bounds = {{-1, -1, -1}, {1, 1, 1}}};
static const struct scene without = {.bounds = {{-1, -1, -1}, {1, 1, 1}}, .origin = {100, 0, 0}};

static bool choose(const struct scene *scene, const char *name, struct camera *out, struct error *err)
{
    struct camera_choice choice = camera_choice_default();
    if (name) {
        choice.source = CAMERA_NAMED;
        choice.name = name;
    }
    memset(err, 0, sizeof *err);
    return camera_choose(scene, &choice, 16.0 / 9, out, err);
}

static void chooses_by_name_and_index(void **state)
{
    (void)state;
    struct camera c;
    struct error err;
    assert_true(choose(&with_cameras, NULL, &c, &err) && c.yfov == 1);
    assert_true(choose(&with_cameras, "side", &c, &err) && c.yfov == 0.5);
    assert_true(choose(&with_cameras, "1", &c, &err) && c.yfov == 0.5);
    assert_true(choose(&with_cameras, "0", &c, &err) && c.yfov == 0.25); /* a name wins over an index */
}

static void frames_the_scene(void **state)
{
    (void)state;
    struct camera c, expected = scene_default_camera(&without, 16.0 / 9);
    struct error err;
    assert_true(choose(&without, NULL, &c, &err));
    assert_true(c.eye.x == expected.eye.x && c.eye.z == expected.eye.z);
    assert_true(choose(&with_cameras, "auto", &c, &err));
    assert_string_not_equal(c.name, "front");
}

static void refuses_and_lists_what_there_is(void **state)
{
    (void)state;
    struct camera c;
    struct error err;
    static const char *const bad[] = {"3", "-1", "", "Front", "99999999999999999999", "front "};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(choose(&with_cameras, bad[i], &c, &err));
        assert_int_equal(err.code, ERROR_USAGE);
        assert_non_null(strstr(err.message, "front, side"));
    }
    assert_false(choose(&without, "0", &c, &err));
    assert_non_null(strstr(err.message, "auto is accepted"));
}

static struct camera_choice look(struct dvec3 eye, struct dvec3 target)
{
    struct camera_choice choice = camera_choice_default();
    choice.source = CAMERA_LOOK_AT;
    choice.eye = eye;
    choice.target = target;
    return choice;
}

static void looks_from_eye_to_target(void **state)
{
    (void)state;
    struct camera_choice choice = look(dvec3(100, 5, 10), dvec3(100, 5, 0));
    struct camera c;
    struct error err = {0};
    assert_true(camera_choose(&without, &choice, 1, &c, &err));
    assert_true(c.eye.x == 0 && c.eye.y == 5 && c.eye.z == 10); /* scene space: less the origin */
    assert_true(c.back.z == 1 && c.right.x == 1 && c.up.y == 1);
    assert_true(fabs(c.yfov - M_PI / 4) < 1e-15);
    assert_true(c.near > 0 && c.far > c.near && !c.orthographic);
}

static void looks_along_parallel_rays(void **state)
{
    (void)state;
    struct camera_choice choice = look(dvec3(100, 5, 10), dvec3(100, 5, 0));
    choice.height = 3;
    struct camera c;
    struct error err = {0};
    assert_true(camera_choose(&without, &choice, 1, &c, &err));
    assert_true(c.orthographic && c.ymag == 1.5 && c.near == 0);
    assert_true(c.far >= 20 && isfinite(c.far)); /* what lies behind the target is seen too */
    choice.height = -1;
    assert_false(camera_choose(&without, &choice, 1, &c, &err));
    assert_string_equal(err.field, "height");
}

static void has_unit_orthogonal_axes(void **state)
{
    (void)state;
    struct camera_choice choice = look(dvec3(3, 7, -2), dvec3(0.1, 0, 5));
    choice.up = dvec3(0.3, 2, 0.1);
    struct camera c;
    struct error err = {0};
    assert_true(camera_choose(&without, &choice, 1, &c, &err));
    const struct dvec3 axes[3] = {c.right, c.up, c.back};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            assert_true(fabs(dvec3_dot(axes[i], axes[j]) - (i == j)) < 1e-15);
    assert_true(dvec3_dot(dvec3_cross(c.right, c.up), c.back) > 0);
}

static void refuses_impossible_views(void **state)
{
    (void)state;
    struct dvec3 eye = dvec3(0, 5, 0), below = dvec3(0, 0, 0), aside = dvec3(1, 0, 0);
    struct camera_choice bad[] = {look(eye, eye),   look(eye, below), look(eye, aside),           look(eye, aside),
                                  look(eye, aside), look(eye, aside), look(eye, dvec3(NAN, 0, 0))};
    bad[2].fov_deg = 0;
    bad[3].fov_deg = 180;
    bad[4].up = dvec3(0, 0, 0);
    bad[5].fov_deg = NAN;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct camera c;
        struct error err = {0};
        if (camera_choose(&without, &bad[i], 1, &c, &err))
            fail_msg("view %zu was taken", i);
        assert_int_equal(err.code, ERROR_USAGE);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chooses_by_name_and_index),       cmocka_unit_test(frames_the_scene),
        cmocka_unit_test(refuses_and_lists_what_there_is), cmocka_unit_test(looks_from_eye_to_target),
        cmocka_unit_test(looks_along_parallel_rays),       cmocka_unit_test(has_unit_orthogonal_axes),
        cmocka_unit_test(refuses_impossible_views),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
