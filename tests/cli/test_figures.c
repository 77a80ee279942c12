#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "figures.h"
#include "frame_name.h"
#include "measure.h"
#include "reference/metrics.h"

static const char *const choices[] = {"1", "32", NULL}, *const words[] = {"exact", "packed", NULL};
static const struct param_desc params[] = {{.name = "size", .kind = PARAM_INT},
                                           {.name = "bias", .kind = PARAM_FLOAT},
                                           {.name = "samples", .kind = PARAM_CHOICE, .choices = choices},
                                           {.name = "layout", .kind = PARAM_CHOICE, .choices = words}};
static const struct shadow_system tested_system = {.name = "tested", .params = params, .param_count = 4};

/* Every path of `path` down `object` must be there: "a.b.c". */
static json_t *at(json_t *object, const char *path)
{
    char copy[64], *rest;
    snprintf(copy, sizeof copy, "%s", path);
    for (char *part = strtok_r(copy, ".", &rest); part && object; part = strtok_r(NULL, ".", &rest))
        object = json_object_get(object, part);
    return object;
}

static void has_every_member_of_the_contract(void **state)
{
    (void)state;
    static const char *const members[] = {"version",
                                          "device",
                                          "scene.triangles",
                                          "scene.drawn_triangles",
                                          "scene.vertices",
                                          "scene.lights",
                                          "algorithm",
                                          "params",
                                          "maps",
                                          "size",
                                          "frames",
                                          "moving",
                                          "frame_ms.min",
                                          "frame_ms.median",
                                          "frame_ms.p95",
                                          "passes.camera_ms",
                                          "passes.receivers_ms",
                                          "passes.prepare_ms",
                                          "passes.resolve_ms",
                                          "passes.lighting_ms",
                                          "passes.readback_ms",
                                          "visibility_ms",
                                          "memory.shadow_bytes",
                                          "memory.shadow_bytes_max",
                                          "memory.peak_bytes"};
    const struct scene scene = {.triangle_count = 1, .drawn_triangle_count = 2, .vertex_count = 3};
    const struct render_settings settings = {
        .width = 5, .height = 4, .light_count = 2, .system = &tested_system, .params = {{1024, 0.5, 1, 0}}};
    const struct device_info device = {.renderer = "soft \xff"};
    struct measurement m = {.frames = 7, .median_ms = 2, .shadow_bytes = 10, .shadow_bytes_max = 20};
    m.pass_ms[PASS_RECEIVERS] = 1, m.pass_ms[PASS_PREPARE] = 2, m.pass_ms[PASS_RESOLVE] = 4;
    m.last.map_count = 2, m.last.map_size = 1024, m.last.map_fov_deg[1] = 90;
    json_t *figures = figures_render(&scene, &settings, &device, &m);
    for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
        if (!at(figures, members[i]))
            fail_msg("%s is missing", members[i]);
    assert_true(json_real_value(at(figures, "visibility_ms")) == 7);
    assert_int_equal(json_integer_value(at(figures, "params.size")), 1024);
    assert_int_equal(json_integer_value(at(figures, "params.samples")), 32);
    assert_string_equal(json_string_value(at(figures, "params.layout")), "exact");
    assert_int_equal(json_array_size(at(figures, "maps")), 2);
    assert_true(json_real_value(json_object_get(json_array_get(at(figures, "maps"), 1), "fov_deg")) == 90);
    assert_int_equal(json_integer_value(json_array_get(at(figures, "size"), 0)), 5);
    assert_true(json_is_false(at(figures, "moving")));
    json_decref(figures);
}

static void has_null_for_what_was_not_measured(void **state)
{
    (void)state;
    const struct metrics m = {.rmse_one_receiver = NAN, .wrong_samples = -1, .receivers = 5};
    json_t *errors = figures_errors(&m);
    assert_true(json_is_null(at(errors, "rmse_one_receiver")));
    assert_true(json_is_null(at(errors, "wrong_samples")));
    assert_int_equal(json_integer_value(at(errors, "receivers")), 5);
    assert_non_null(at(errors, "boundary.edge_shift_max"));
    json_decref(errors);
}

static void tells_what_the_system_tells(void **state)
{
    (void)state;
    struct frame_info frame = {.frame_ms = 3, .shadow_bytes = 5, .converged = true};
    json_t *row = figures_frame(&frame);
    assert_null(at(row, "figures"));
    assert_true(json_is_true(at(row, "converged")) && json_is_false(at(row, "prepared")));
    json_decref(row);
    frame.figures[frame.figure_count++] = (struct shadow_figure){"nodes", 12};
    frame.figures[frame.figure_count++] = (struct shadow_figure){"share", NAN};
    row = figures_frame(&frame);
    assert_true(json_real_value(at(row, "figures.nodes")) == 12);
    assert_true(json_is_null(at(row, "figures.share")));
    json_decref(row);
}

static void numbers_the_frames_of_a_pattern(void **state)
{
    (void)state;
    char name[32];
    assert_true(frame_name("out/frame.####.exr", 7, name, sizeof name));
    assert_string_equal(name, "out/frame.0007.exr");
    assert_true(frame_name("a#b##", 123, name, sizeof name));
    assert_string_equal(name, "a#b123");
    assert_false(frame_name("out#/frame.exr", 7, name, sizeof name));
    assert_false(frame_name("frame.####.exr", 7, name, 8));
}

static void takes_quantiles_by_nearest_rank(void **state)
{
    (void)state;
    double one[] = {3}, four[] = {4, 1, 3, 2}, twenty[20];
    assert_true(quantile(one, 1, 0) == 3 && quantile(one, 1, 0.5) == 3 && quantile(one, 1, 0.95) == 3);
    assert_true(quantile(four, 4, 0) == 1 && quantile(four, 4, 0.5) == 2.5 && quantile(four, 4, 1) == 4);
    for (int i = 0; i < 20; i++)
        twenty[i] = 20 - i;
    assert_true(quantile(twenty, 20, 0.95) == 19);
}

static void times_fewer_frames_where_they_are_slow(void **state)
{
    (void)state;
    assert_int_equal(measure_default_frames(0), 20);
    assert_int_equal(measure_default_frames(500), 20);
    assert_int_equal(measure_default_frames(1000), 10);
    assert_int_equal(measure_default_frames(1e9), 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(has_every_member_of_the_contract), cmocka_unit_test(has_null_for_what_was_not_measured),
        cmocka_unit_test(tells_what_the_system_tells),      cmocka_unit_test(numbers_the_frames_of_a_pattern),
        cmocka_unit_test(takes_quantiles_by_nearest_rank),  cmocka_unit_test(times_fewer_frames_where_they_are_slow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
