/* Rasterizer and tracer make the same ids and the same maps. */
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
    set.settings.camera.far = INFINITY;
    check_cameras(&set, 0.01, "cards, orthographic without a far end");
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
        /* Counter-clockwise is the front; a mirrored instance's winding is turned round: its front stays where it was. */
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
        int size = shadow_param_index(shadow_systems[i], "size");
        if (!(shadow_systems[i]->flags & (SHADOW_USES_MAPS | SHADOW_USES_FIT)))
            continue;
        set->settings.system = shadow_systems[i];
        set->settings.params = shadow_defaults(shadow_systems[i]);
        if (size >= 0)
            set->settings.params.value[size] = 512;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cameras_agree),
        cmocka_unit_test(test_cards_agree),
        cmocka_unit_test(test_back_faces),
        cmocka_unit_test(test_maps_agree),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
