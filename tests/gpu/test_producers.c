/* Rasterizer and tracer make the same ids and the same maps; what is rebuilt when; the ring of frames; formats, sizes, `show`. */
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

/* A pixel whose neighbours all have its id in both pictures: rounding of edges cannot explain a difference there. */
static bool is_interior(const uint32_t *ids, uint32_t width, uint32_t height, uint32_t x, uint32_t y)
{
    if (x == 0 || y == 0 || x + 1 == width || y + 1 == height)
        return false;
    for (uint32_t j = y - 1; j <= y + 1; j++)
        for (uint32_t i = x - 1; i <= x + 1; i++)
            if (ids[j * width + i] != ids[y * width + x])
                return false;
    return true;
}

/* Depths as `show` draws them, 16 bits of mantissa and more in float. */
static void check_depths(const struct shot *raster, const struct shot *traced, const char *name)
{
    const float *a = (const float *)(const void *)raster->pixels, *b = (const float *)(const void *)traced->pixels;
    for (size_t i = 0; i < (size_t)raster->width * raster->height; i++)
        if (raster->ids[i] == traced->ids[i] && fabsf(a[4 * i] - b[4 * i]) > 2e-5f * fmaxf(a[4 * i], 0.01f))
            fail_msg("%s: depth %.9g rasterized, %.9g traced at pixel %zu", name, a[4 * i], b[4 * i], i);
}

/* The share of pixels that may differ, all of them along edges. */
static void check_cameras(struct set *set, double share, const char *name)
{
    set->settings.show = SHOW_DEPTH;
    set->settings.format = PIXELS_RGBA32F;
    set->settings.camera_pass = CAMERA_PASS_RASTER;
    struct shot raster = shot_take(&studio, set);
    set->settings.camera_pass = CAMERA_PASS_TRACED;
    struct shot traced = shot_take(&studio, set);
    assert_true(traced.info.traced_camera && !raster.info.traced_camera);
    size_t differ = 0, surfaces = 0;
    for (uint32_t y = 0; y < raster.height; y++)
        for (uint32_t x = 0; x < raster.width; x++) {
            size_t i = (size_t)y * raster.width + x;
            surfaces += raster.ids[i] != SCENE_NONE;
            if (raster.ids[i] == traced.ids[i])
                continue;
            differ++;
            if (is_interior(raster.ids, raster.width, raster.height, x, y) &&
                is_interior(traced.ids, raster.width, raster.height, x, y))
                fail_msg("%s: pixel %u, %u shows %u rasterized and %u traced, away from any edge", name, x, y, raster.ids[i],
                         traced.ids[i]);
        }
    assert_true(surfaces > 500);
    if ((double)differ > share * (double)raster.width * raster.height)
        fail_msg("%s: %zu of %zu pixels differ between rasterizer and tracer", name, differ,
                 (size_t)raster.width * raster.height);
    check_depths(&raster, &traced, name);
    shot_drop(&raster);
    shot_drop(&traced);
}

static void test_cameras_agree(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double share;
    } scenes[] = {{"builtin:box", 0.002},
                  {"builtin:ball", 0.01},
                  {"builtin:tree", 0.03},
                  {"builtin:butterfly", 0.03},
                  {"builtin:dragon:triangles=20000", 0.01},
                  {"builtin:hard-04-contact", 0.003},
                  {"builtin:hard-06-fan", 0.01},
                  {"builtin:hard-11-degenerate", 0.003},
                  {"builtin:hard-20-twosided", 0.005},
                  {"builtin:hard-21-grid", 0.004}};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        struct set set = set_load(&studio, scenes[i].name);
        set.settings.width = 192;
        set.settings.height = 128;
        check_cameras(&set, scenes[i].share, scenes[i].name);
        set_strike(&set);
    }
}

/* Masked, single- and double-sided, mirrored and sheared instances of one card. */
static struct scene *make_cards(void)
{
    struct scene *scene = made_scene();
    uint32_t plain = made_material(scene, false), masked = made_material(scene, true), hidden = made_material(scene, false);
    uint8_t solid[64];
    for (int i = 0; i < 64; i++)
        solid[i] = ((i >> 1) ^ (i >> 4)) & 1;
    made_mask(scene, masked, 8, solid);
    const float points[4][3] = {{-0.5f, 0, 0}, {0.5f, 0, 0}, {0.5f, 1, 0}, {-0.5f, 1, 0}};
    const float uv[4][2] = {{-0.3f, 0}, {1.7f, 0}, {1.7f, 1}, {-0.3f, 1}};
    const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    uint32_t card = made_mesh(scene, points, uv, 4, indices, 6, masked),
             sheet = made_mesh(scene, points, NULL, 4, indices, 6, hidden);
    const double places[6][4] = {{-1.4, 0.3, 1, 1},  {-0.4, -0.4, -1, 1}, {0.8, 0.2, 1, -1},
                                 {1.6, 0.6, -1, -1}, {0.2, 1, 1, 1},      {-1, 1, 1, 1}};
    for (int i = 0; i < 6; i++) {
        struct affine a = affine_identity();
        double turn = 0.4 * i;
        a.linear[0][0] = places[i][2] * cos(turn);
        a.linear[0][1] = 0.3;
        a.linear[0][2] = sin(turn);
        a.linear[2][0] = -places[i][2] * sin(turn);
        a.linear[2][2] = places[i][3] * cos(turn);
        a.offset[0] = places[i][0];
        a.offset[2] = places[i][1];
        made_instance(scene, i % 2 ? sheet : card, a);
    }
    const float floor[6][3] = {{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {-3, 0, -3}, {3, 0, 3}, {3, 0, -3}};
    made_triangles(scene, floor, 6, plain);
    made_finish(scene);
    return scene;
}

static struct set make_card_set(void)
{
    struct set set = set_build(&studio, make_cards());
    set.settings.width = 192;
    set.settings.height = 128;
    set.settings.camera = made_camera(dvec3(0.4, 1.6, 4), dvec3(0, 0.4, 0), 0.8);
    set.settings.lights[0] = made_light(LIGHT_POINT, dvec3(2, 4, 2), dvec3(0, 0, 0));
    return set;
}

static void test_cards_agree(void **state)
{
    (void)state;
    struct set set = make_card_set();
    struct camera camera = set.settings.camera;
    check_cameras(&set, 0.01, "cards");
    set.settings.camera.orthographic = true;
    set.settings.camera.ymag = 1.5;
    set.settings.camera.far = 20;
    check_cameras(&set, 0.01, "cards, orthographic");
    set.settings.camera.near = 4.1;
    set.settings.camera.far = 5;
    check_cameras(&set, 0.01, "cards between planes, orthographic");
    set.settings.camera = camera;
    set.settings.camera.near = 4;
    check_cameras(&set, 0.01, "cards, cut by the near plane");
    set.settings.camera = camera;
    set.settings.camera.far = 4.5;
    check_cameras(&set, 0.01, "cards, cut by the far plane");
    set.settings.camera = made_camera(dvec3(0.4, 1.6, -4), dvec3(0, 0.4, 0), 0.8);
    check_cameras(&set, 0.01, "cards from behind");
    set.settings.camera = made_camera(dvec3(0.2, 0.5, 0.3), dvec3(0, 0.4, -1), 1.5);
    check_cameras(&set, 0.01, "among cards");
    set_strike(&set);
}

/* double_sided = false hides back faces, whatever the sign of the determinant: a sheet seen from one side only. */
static size_t pixels_of_sheet(bool double_sided, bool mirrored, double eye_z)
{
    struct scene *scene = made_scene();
    const float points[6][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    const uint32_t indices[6] = {0, 1, 2, 3, 4, 5};
    struct affine a = affine_identity();
    a.linear[0][0] = mirrored ? -1 : 1;
    made_instance(scene, made_mesh(scene, points, NULL, 6, indices, 6, made_material(scene, double_sided)), a);
    made_finish(scene);
    struct set set = set_build(&studio, scene);
    set.settings.camera = made_camera(dvec3(0, 0, eye_z), dvec3(0, 0, 0), 1);
    size_t count[2] = {0, 0};
    for (int traced = 0; traced < 2; traced++) {
        set.settings.camera_pass = traced ? CAMERA_PASS_TRACED : CAMERA_PASS_RASTER;
        struct shot shot = shot_take(&studio, &set);
        for (size_t i = 0; i < (size_t)shot.width * shot.height; i++)
            count[traced] += shot.ids[i] != SCENE_NONE;
        shot_drop(&shot);
    }
    set_strike(&set);
    assert_int_equal(count[0] > 0, count[1] > 0);
    return count[0];
}

static void test_back_faces(void **state)
{
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        /* Counter-clockwise is the front; a mirrored instance's winding is turned round, so its front stays where the mesh says. */
        assert_true(pixels_of_sheet(false, mirrored, 3) > 500);
        assert_int_equal(pixels_of_sheet(false, mirrored, -3), 0);
        assert_true(pixels_of_sheet(true, mirrored, 3) > 500);
        assert_true(pixels_of_sheet(true, mirrored, -3) > 500);
    }
}

/* Visibility from rasterized and from traced maps. */
static void check_maps(struct set *set, double share, const char *name)
{
    for (size_t i = 0; i < shadow_system_count; i++) {
        if (!(shadow_systems[i]->flags & SHADOW_USES_MAPS))
            continue;
        set->settings.system = shadow_systems[i];
        set->settings.params = shadow_defaults(shadow_systems[i]);
        set->settings.params.value[shadow_param_index(shadow_systems[i], "size")] = 512;
        set->settings.map_pass = CAMERA_PASS_RASTER;
        struct shot raster = shot_take(&studio, set);
        set->settings.map_pass = CAMERA_PASS_TRACED;
        struct shot traced = shot_take(&studio, set);
        assert_true(raster.info.prepared && traced.info.prepared);
        double differ = 0;
        size_t pixels = (size_t)raster.width * raster.height;
        for (size_t k = 0; k < pixels; k++)
            differ += fabs((double)raster.visibility[0][k] - (double)traced.visibility[0][k]) > 0.25;
        if (differ > share * (double)pixels)
            fail_msg("%s, %s: %g of %zu pixels differ between rasterized and traced maps", shadow_systems[i]->name, name, differ,
                     pixels);
        shot_drop(&raster);
        shot_drop(&traced);
    }
}

static void test_maps_agree(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double share;
    } scenes[] = {{"builtin:box", 0.003},
                  {"builtin:ball", 0.01},
                  {"builtin:tree", 0.01},
                  {"builtin:hard-11-degenerate", 0.005},
                  {"builtin:hard-20-twosided", 0.005}};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        struct set set = set_load(&studio, scenes[i].name);
        check_maps(&set, scenes[i].share, scenes[i].name);
        set_strike(&set);
    }
    struct set set = make_card_set();
    static const char *const names[] = {"cards, directional", "cards, point", "cards, spot"};
    static const enum light_kind kinds[] = {LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPOT};
    for (int k = 0; k < 3; k++) {
        set.settings.lights[0] = made_light(kinds[k], dvec3(2, 4, 2), dvec3(0, 0, 0));
        check_maps(&set, 0.01, names[k]);
    }
    /* Inside the scene: cube faces, casters before their near planes. */
    set.settings.lights[0] = made_light(LIGHT_POINT, dvec3(0.3, 0.4, 0.7), dvec3(0, 0, 0));
    check_maps(&set, 0.02, "a light among cards");
    set_strike(&set);
}

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
        cmocka_unit_test(test_cameras_agree),    cmocka_unit_test(test_cards_agree),
        cmocka_unit_test(test_back_faces),       cmocka_unit_test(test_maps_agree),
        cmocka_unit_test(test_what_rebuilds),    cmocka_unit_test(test_states_are_freed),
        cmocka_unit_test(test_ring_keeps_order), cmocka_unit_test(test_wrong_sizes_are_refused),
        cmocka_unit_test(test_more_samples),     cmocka_unit_test(test_float_pictures_are_linear),
        cmocka_unit_test(test_every_show),       cmocka_unit_test(test_empty_scenes),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
