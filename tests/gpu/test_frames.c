/* What a frame promises: nothing is rebuilt that need not be, frames come back in order, sizes and formats are what was asked
 * for, every `show` says what it says. */
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
#include "render_scene.h"
#include "studio.h"

static struct studio studio;

static bool prepared(struct set *set)
{
    struct shot shot = shot_take(&studio, set);
    bool result = shot.info.prepared;
    shot_drop(&shot);
    return result;
}

static void test_what_rebuilds(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:hard-04-contact");
    for (size_t i = 0; i < shadow_system_count; i++) {
        if (!(shadow_systems[i]->flags & SHADOW_USES_MAPS))
            continue;
        set.settings.system = shadow_systems[i];
        set.settings.params = shadow_defaults(shadow_systems[i]);
        struct light *light = &set.settings.lights[0];
        const struct light before = *light;
        assert_true(prepared(&set));
        assert_false(prepared(&set));
        set.settings.camera.eye.x += 0.25;
        assert_false(prepared(&set));
        set.settings.width = 80;
        assert_false(prepared(&set));
        light->color[1] = 0.5f;
        light->intensity *= 2;
        assert_false(prepared(&set));
        light->position.x += 1e-9;
        assert_true(prepared(&set));
        assert_false(prepared(&set));
        *light = light_turned(set.scene, light, 0.25);
        assert_true(prepared(&set));
        set.settings.params.value[shadow_param_index(shadow_systems[i], "size")] = 64;
        assert_true(prepared(&set));
        light->range = 30;
        assert_true(prepared(&set));
        *light = before;
    }
    set_strike(&set);
}

static size_t count_states(const struct set *set)
{
    size_t n = 0;
    for (const struct light_state *s = set->uploaded->states.first; s; s = s->next)
        n++;
    return n;
}

static double lists_made(struct set *set)
{
    struct shot shot = shot_take(&studio, set);
    double made = shot.info.figure_count > 0 ? shot.info.figures[0].value : -1;
    shot_drop(&shot);
    return made;
}

/* A camera that moves makes the lists that it newly reads, a light all. */
static void test_what_lists_are_made(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:ball");
    set_use(&set, "coverage:size=64");
    set.settings.width = 384;
    set.settings.height = 256;
    double first = lists_made(&set);
    assert_true(first > 100);
    assert_true(lists_made(&set) == 0);
    set.settings.camera.eye.x += 0.05;
    double added = lists_made(&set);
    assert_true(added > 0 && added < first / 4);
    set.settings.camera.eye.x -= 0.05;
    assert_true(lists_made(&set) == 0);
    set.settings.lights[0] = light_turned(set.scene, &set.settings.lights[0], 0.25);
    assert_true(lists_made(&set) > first / 2);
    set_strike(&set);
}

/* States that no frame asks for are freed; a moving light keeps one. */
static void test_states_are_freed(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:hard-04-contact");
    set.settings.width = set.settings.height = 16;
    set_use(&set, "sm:size=16");
    for (int i = 0; i < 100; i++) {
        set.settings.lights[0].position.x += 0.01;
        assert_true(prepared(&set));
    }
    assert_int_equal(count_states(&set), 1);
    for (int i = 0; i < 40; i++) {
        char algorithm[32];
        snprintf(algorithm, sizeof algorithm, "sm:size=%d", 17 + i);
        set_use(&set, algorithm);
        assert_true(prepared(&set));
    }
    size_t most = count_states(&set);
    for (int i = 0; i < 100; i++)
        prepared(&set);
    if (most < 2 || count_states(&set) != 1)
        fail_msg("%zu states after 41 parameters, and %zu a hundred frames later", most, count_states(&set));
    set_strike(&set);
}

/* Frames come back in order, whole, each with its own size and token; one too many is refused and does no harm. */
static void test_ring_keeps_order(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:box");
    struct shot alone[RENDERER_IN_FLIGHT];
    for (uint32_t i = 0; i < RENDERER_IN_FLIGHT; i++) {
        set.settings.width = 40 + 8 * i;
        set.settings.camera.eye.x += 0.2;
        alone[i] = shot_take(&studio, &set);
    }
    struct error err = {0};
    set.settings.camera.eye.x -= 0.2 * RENDERER_IN_FLIGHT;
    for (uint32_t i = 0; i < RENDERER_IN_FLIGHT; i++) {
        set.settings.width = 40 + 8 * i;
        set.settings.camera.eye.x += 0.2;
        assert_true(renderer_submit(studio.renderer, set.uploaded, &set.settings, 100 + i, &err));
    }
    assert_false(renderer_submit(studio.renderer, set.uploaded, &set.settings, 1, &err));
    assert_int_equal(err.code, ERROR_TRY_AGAIN);
    for (uint32_t i = 0; i < RENDERER_IN_FLIGHT; i++) {
        uint32_t width, height;
        enum pixel_format format;
        struct frame_info info;
        uint8_t *pixels = calloc(1, alone[i].size);
        assert_true(renderer_oldest(studio.renderer, &width, &height, &format));
        assert_int_equal(width, 40 + 8 * i);
        assert_int_equal(format, PIXELS_RGBA8);
        err = (struct error){0};
        bool got = false;
        for (long tries = 0; !got && tries < 100000000; tries++)
            got = renderer_collect(studio.renderer, i == 1, pixels, alone[i].size, &info, &err);
        assert_true(got);
        assert_int_equal(info.token, 100 + i);
        assert_int_equal(info.width, width);
        assert_memory_equal(pixels, alone[i].pixels, alone[i].size);
        free(pixels);
        shot_drop(&alone[i]);
    }
    struct frame_info info;
    uint32_t width, height;
    enum pixel_format format;
    assert_false(renderer_collect(studio.renderer, true, NULL, 0, &info, &err));
    assert_int_equal(err.code, ERROR_NONE);
    assert_false(renderer_oldest(studio.renderer, &width, &height, &format));
    set_strike(&set);
}

static void test_wrong_sizes_are_refused(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:box");
    static const struct {
        uint32_t width, height;
        unsigned aa;
    } wrong[] = {{0, 10, 1},
                 {10, 0, 1},
                 {RENDERER_SIZE_MAX + 1, 1, 1},
                 {1, UINT32_MAX, 1},
                 {RENDERER_SIZE_MAX, 1, 4},
                 {RENDERER_SIZE_MAX / 4 + 1, 1, 16}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct error err = {0};
        set.settings.width = wrong[i].width;
        set.settings.height = wrong[i].height;
        set.settings.aa = wrong[i].aa;
        assert_false(renderer_submit(studio.renderer, set.uploaded, &set.settings, 0, &err));
        assert_int_equal(err.code, ERROR_USAGE);
        assert_string_equal(err.field, "size");
    }
    set.settings.aa = 1;
    set.settings.width = set.settings.height = 1;
    struct shot shot = shot_take(&studio, &set);
    shot_drop(&shot);
    set_strike(&set);
}

/* Means over 4 x 4 blocks: a picture with more samples differs along edges only. */
static void test_more_samples(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:box");
    struct shot one = shot_take(&studio, &set);
    for (unsigned aa = 4; aa <= 16; aa *= 4)
        for (int traced = 0; traced < 2; traced++) {
            set.settings.aa = aa;
            set.settings.camera_pass = traced ? CAMERA_PASS_TRACED : CAMERA_PASS_RASTER;
            struct shot many = shot_take(&studio, &set);
            assert_int_equal(many.size, one.size);
            double sum = 0, far_off = 0;
            for (size_t i = 0; i < one.size; i++) {
                double d = fabs((double)one.pixels[i] - many.pixels[i]);
                sum += d;
                far_off += d > 24;
            }
            assert_true(sum > 0);
            if (sum / (double)one.size > 4 || far_off > 0.12 * (double)one.size)
                fail_msg("aa %u: mean difference %g, %g channels far off", aa, sum / (double)one.size, far_off);
            shot_drop(&many);
        }
    shot_drop(&one);
    set_strike(&set);
}

static double srgb(double linear)
{
    linear = fmin(fmax(linear, 0), 1);
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

/* Floats are the linear picture: sRGB of them is the 8-bit one; twice the exposure is twice the value. */
static void test_float_pictures_are_linear(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:box");
    set.settings.tonemap = TONEMAP_NONE;
    set.settings.exposure_auto = false;
    set.settings.exposure_ev = -1;
    struct shot bytes = shot_take(&studio, &set);
    set.settings.format = PIXELS_RGBA32F;
    struct shot wide = shot_take(&studio, &set);
    set.settings.exposure_ev = 0;
    set.settings.tonemap = TONEMAP_ACES;
    struct shot brighter = shot_take(&studio, &set);
    const float *w = (const float *)(const void *)wide.pixels, *b = (const float *)(const void *)brighter.pixels;
    for (size_t i = 0; i < (size_t)wide.width * wide.height * 4; i++) {
        bool surface = wide.ids[i / 4] != SCENE_NONE;
        if (i % 4 == 3) {
            assert_true(w[i] == 1 && bytes.pixels[i] == 255);
        } else if (surface) {
            if (fabs(255 * srgb(w[i]) - bytes.pixels[i]) > 1)
                fail_msg("channel %zu is %g linear and %u as a byte", i, w[i], bytes.pixels[i]);
            if (fabsf(2 * w[i] - b[i]) > 1e-5f * b[i] + 1e-7f)
                fail_msg("channel %zu goes from %g to %g with one stop", i, w[i], b[i]);
        }
    }
    shot_drop(&bytes);
    shot_drop(&wide);
    shot_drop(&brighter);
    set_strike(&set);
}

/* show: what it draws is what it says, and nothing fails in either format. */
static void test_every_show(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:hard-04-contact");
    set.settings.format = PIXELS_RGBA32F;
    for (int show = SHOW_SHADED; show <= SHOW_ID; show++) {
        set.settings.show = (enum show)show;
        struct shot shot = shot_take(&studio, &set);
        const float *p = (const float *)(const void *)shot.pixels;
        for (size_t i = 0; i < (size_t)shot.width * shot.height; i++) {
            for (int k = 0; k < 3; k++)
                if (!(p[4 * i + (size_t)k] >= 0 && p[4 * i + (size_t)k] < 1e6f))
                    fail_msg("show %d: %g at pixel %zu", show, p[4 * i + (size_t)k], i);
            if (shot.ids[i] == SCENE_NONE)
                continue;
            if (show == SHOW_VISIBILITY)
                assert_true(p[4 * i] == shot.visibility[0][i]);
            float n[3] = {2 * p[4 * i] - 1, 2 * p[4 * i + 1] - 1, 2 * p[4 * i + 2] - 1};
            if (show == SHOW_NORMAL)
                assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-3f);
            if (show == SHOW_ID && i > 0 && shot.ids[i - 1] == shot.ids[i])
                assert_memory_equal(&p[4 * i], &p[4 * i - 4], 12);
        }
        shot_drop(&shot);
    }
    set_strike(&set);
}

/* Nothing to draw, no light: a background, and no error. */
static void test_empty_scenes(void **state)
{
    (void)state;
    struct scene *scene = made_scene();
    made_material(scene, false);
    made_finish(scene);
    struct set set = set_build(&studio, scene);
    for (int traced = 0; traced < 2; traced++)
        for (size_t lights = 0; lights < 2; lights++)
            for (size_t i = 0; i < shadow_system_count; i++) {
                set.settings.camera_pass = set.settings.map_pass = traced ? CAMERA_PASS_TRACED : CAMERA_PASS_RASTER;
                set.settings.light_count = lights;
                set.settings.system = shadow_systems[i];
                set.settings.params = shadow_defaults(shadow_systems[i]);
                struct shot shot = shot_take(&studio, &set);
                for (size_t k = 0; k < (size_t)shot.width * shot.height; k++) {
                    assert_int_equal(shot.ids[k], SCENE_NONE);
                    assert_memory_equal(shot.pixels + 4 * k, shot.pixels, 4);
                    assert_true(lights == 0 || shot.visibility[0][k] == 0);
                }
                shot_drop(&shot);
            }
    set_strike(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_rebuilds),
        cmocka_unit_test(test_what_lists_are_made),
        cmocka_unit_test(test_states_are_freed),
        cmocka_unit_test(test_ring_keeps_order),
        cmocka_unit_test(test_wrong_sizes_are_refused),
        cmocka_unit_test(test_more_samples),
        cmocka_unit_test(test_float_pictures_are_linear),
        cmocka_unit_test(test_every_show),
        cmocka_unit_test(test_empty_scenes),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
