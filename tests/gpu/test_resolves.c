/* Pixels compared with depth maps by shaders and on the CPU: the same visibility, but for roundings. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/error.h"
#include "made_scene.h"
#include "studio.h"

static struct studio studio;

/* Values further apart than this are told from roundings: a texel of pcf's 25 weighs 0.04, a step of soft's term 0.001. */
#define STEP 0.02

static double share_of_others(const struct shot *a, const struct shot *b)
{
    size_t pixels = (size_t)a->width * a->height, other = 0;
    for (size_t i = 0; i < pixels; i++)
        other += fabsf(a->visibility[0][i] - b->visibility[0][i]) > STEP;
    return (double)other / (double)pixels;
}

static struct shot shot_by(struct set *set, enum resolve_pass pass, const char *algorithm)
{
    set_use(set, algorithm);
    set->settings.resolve_pass = pass;
    return shot_take(&studio, set);
}

/* A point that lies just at its bias, or at a texel's border, may go either way; so a share. */
static const struct {
    const char *name;
    double share;
} systems[] = {{"sm:size=256", 0.001},
               {"pcf:size=256", 0.001},
               {"apcf:size=256", 0.001},
               {"soft:size=256", 0.002},
               {"none", 0.001},
               {"sm:size=256,bias=0,slope=0.5,fit=cube", 0.002},
               {"pcf:size=256,kernel=1", 0.001},
               {"pcf:size=64,kernel=31", 0.001},
               {"pcf:size=16,kernel=31", 0.001},
               {"apcf:size=256,template=9,weights=sum,umbra=0.25", 0.001},
               {"apcf:size=64,template=3,weights=flat", 0.002},
               {"soft:size=128,near=1,far=4,lift=0.5", 0.002}};
enum { PLAIN = 5, ALL = sizeof systems / sizeof systems[0] };

/* maps: what the light needs of a system that uses some, 0: unknown. */
static void check_system(struct set *set, const char *name, const char *algorithm, double most, unsigned maps)
{
    struct shot gpu = shot_by(set, RESOLVE_PASS_GPU, algorithm), cpu = shot_by(set, RESOLVE_PASS_CPU, algorithm);
    assert_true(maps == 0 || gpu.info.map_count == 0 || gpu.info.map_count == maps);
    double share = share_of_others(&gpu, &cpu);
    if (share > most)
        fail_msg("%s, %s: %g of the pixels differ between GPU and CPU", name, algorithm, share);
    shot_drop(&gpu);
    shot_drop(&cpu);
}

static void check(struct set *set, const char *name, size_t count, unsigned maps)
{
    for (size_t i = 0; i < count; i++)
        check_system(set, name, systems[i].name, systems[i].share, maps);
}

/* Rasterized pages are the GPU's only. */
static void check_trees(struct set *set, const char *name, unsigned maps)
{
    enum camera_pass before = set->settings.map_pass;
    set->settings.map_pass = CAMERA_PASS_TRACED;
    check_system(set, name, "asm:budget=2", 0.001, maps);
    check_system(set, name, "asm:budget=1,analyse=3,detail=1,bias=0,slope=0.5,fit=cube", 0.001, 0);
    set->settings.map_pass = before;
}

static void test_scenes_agree(void **state)
{
    (void)state;
    static const char *const names[] = {"builtin:box", "builtin:contact", "builtin:tree", "builtin:hard-11-degenerate"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct set set = set_load(&studio, names[i]);
        set.settings.width = 187; /* no multiple of eight */
        set.settings.height = 107;
        check(&set, names[i], PLAIN, 0);
        set.settings.map_pass = CAMERA_PASS_TRACED;
        set.settings.camera_pass = CAMERA_PASS_TRACED;
        check(&set, names[i], PLAIN, 0);
        check_trees(&set, names[i], 0);
        set_strike(&set);
    }
}

static void test_trees_agree(void **state)
{
    (void)state;
    static const char *const names[] = {"builtin:ball", "builtin:hard-09-thin", "builtin:hard-15-offset",
                                        "builtin:hard-17-ratio"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct set set = set_load(&studio, names[i]);
        check_trees(&set, names[i], 0);
        set_strike(&set);
    }
}

/* A slab and three boxes above it, all around the origin. */
static struct set make_boxes(void)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true);
    const float floor[6][3] = {{-3, -1, -3}, {-3, -1, 3}, {3, -1, 3}, {-3, -1, -3}, {3, -1, 3}, {3, -1, -3}};
    made_triangles(scene, floor, 6, material);
    for (int i = 0; i < 18; i++) {
        float a = 0.7f * (float)i, x = cosf(a), z = sinf(a), h = -0.6f + 0.1f * (float)i;
        const float card[6][3] = {{x - 0.2f, h, z},        {x + 0.2f, h, z - 0.1f}, {x, h + 0.4f, z + 0.1f},
                                  {x - 0.2f, h + 0.1f, z}, {x, h + 0.2f, z - 0.3f}, {x, h - 0.2f, z + 0.2f}};
        made_triangles(scene, card, 6, material);
    }
    made_finish(scene);
    struct set set = set_build(&studio, scene);
    set.settings.width = 187;
    set.settings.height = 107;
    set.settings.camera = made_camera(dvec3(2.5, 2, 3.5), dvec3(0, -0.3, 0), 0.7);
    return set;
}

static void test_lights_agree(void **state)
{
    (void)state;
    struct set set = make_boxes();
    set.settings.lights[0] = made_light(LIGHT_DIRECTIONAL, dvec3(2, 4, 1), dvec3(0, 0, 0));
    check(&set, "directional", ALL, 1);
    check_trees(&set, "directional", 1);
    set.settings.lights[0] = made_light(LIGHT_POINT, dvec3(2, 4, 1), dvec3(0, 0, 0));
    check(&set, "point", PLAIN, 0);
    check_trees(&set, "point", 0);
    set.settings.lights[0].range = 4.5;
    check(&set, "point with a range", 1, 0);
    check_trees(&set, "point with a range", 0);
    set.settings.lights[0] = made_light(LIGHT_POINT, dvec3(0.1, 0.2, 0.05), dvec3(0, 0, 0));
    check(&set, "among them", ALL, 6);
    check_trees(&set, "among them", 6);
    set.settings.lights[0] = made_light(LIGHT_SPOT, dvec3(1, 4, 0.5), dvec3(0, 0, 0));
    set.settings.lights[0].outer = 0.3;
    check(&set, "spot", PLAIN, 1);
    check_trees(&set, "spot", 1);
    set.settings.camera.orthographic = true;
    set.settings.camera.ymag = 2;
    set.settings.camera.far = 20;
    check(&set, "spot, orthographic camera", PLAIN, 1);
    check_trees(&set, "spot, orthographic camera", 1);
    set_strike(&set);
}

/* What the camera sees has textures: pixels are read back. Two lights read them once. */
static void test_textures_agree(void **state)
{
    (void)state;
    struct scene *scene = made_scene();
    uint32_t masked = made_material(scene, true);
    const uint8_t solid[4] = {1, 0, 1, 1};
    const float points[4][3] = {{-1, 0.2f, -1}, {1, 0.2f, -1}, {1, 0.8f, 1}, {-1, 0.8f, 1}},
                uv[4][2] = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
    const float floor[6][3] = {{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {-2, 0, -2}, {2, 0, 2}, {2, 0, -2}};
    const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    made_mask(scene, masked, 2, solid);
    made_instance(scene, made_mesh(scene, points, uv, 4, indices, 6, masked), affine_identity());
    made_triangles(scene, floor, 6, made_material(scene, true));
    made_finish(scene);
    struct set set = set_build(&studio, scene);
    set.settings.camera = made_camera(dvec3(1, 3, 4), dvec3(0, 0, 0), 0.8);
    set.settings.lights[0] = made_light(LIGHT_POINT, dvec3(1, 3, 0.5), dvec3(0, 0, 0));
    for (int traced = 0; traced < 2; traced++) {
        set.settings.camera_pass = set.settings.map_pass = traced ? CAMERA_PASS_TRACED : CAMERA_PASS_RASTER;
        check(&set, traced ? "holes, traced" : "holes, rasterized", PLAIN, 0);
        check_trees(&set, "holes", 0);
    }
    set.settings.lights[1] = made_light(LIGHT_DIRECTIONAL, dvec3(-1, 3, 0.5), dvec3(0, 0, 0));
    set.settings.light_count = 2;
    struct shot both = shot_by(&set, RESOLVE_PASS_CPU, "sm:size=256");
    set.settings.lights[0] = set.settings.lights[1];
    set.settings.light_count = 1;
    struct shot second = shot_by(&set, RESOLVE_PASS_CPU, "sm:size=256");
    assert_memory_equal(both.visibility[1], second.visibility[0], (size_t)both.width * both.height * sizeof(float));
    shot_drop(&both);
    shot_drop(&second);
    set_strike(&set);
}

/* The comparison above can fail: another size, another bias. */
static void test_others_do_not_agree(void **state)
{
    (void)state;
    struct set set = make_boxes();
    set.settings.lights[0] = made_light(LIGHT_POINT, dvec3(2, 4, 1), dvec3(0, 0, 0));
    struct shot a = shot_by(&set, RESOLVE_PASS_GPU, "sm:size=256"), b = shot_by(&set, RESOLVE_PASS_CPU, "sm:size=224");
    assert_true(share_of_others(&a, &b) > 0.002);
    shot_drop(&a);
    shot_drop(&b);
    a = shot_by(&set, RESOLVE_PASS_GPU, "soft:size=256");
    b = shot_by(&set, RESOLVE_PASS_CPU, "soft:size=256,far=1");
    assert_true(share_of_others(&a, &b) > 0.002);
    shot_drop(&a);
    shot_drop(&b);
    set.settings.map_pass = CAMERA_PASS_TRACED;
    a = shot_by(&set, RESOLVE_PASS_GPU, "asm:budget=2");
    b = shot_by(&set, RESOLVE_PASS_CPU, "asm:budget=2,detail=0.5");
    assert_true(share_of_others(&a, &b) > 0.002);
    shot_drop(&a);
    shot_drop(&b);
    set_strike(&set);
}

/* On the CPU there is no texture of the map, traced or rasterized, unless holes left it to GL. */
static void test_bytes(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:box");
    size_t map = (size_t)256 * 256 * sizeof(float), bytes[2];
    for (int traced = 0; traced < 2; traced++) {
        set.settings.map_pass = traced ? CAMERA_PASS_TRACED : CAMERA_PASS_RASTER;
        struct shot shot = shot_by(&set, RESOLVE_PASS_CPU, "sm:size=256");
        bytes[traced] = shot.info.shadow_bytes;
        shot_drop(&shot);
    }
    assert_in_range(bytes[1], map, map + 4096);
    assert_in_range(bytes[0], map, map + 65536);
    set_strike(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scenes_agree),   cmocka_unit_test(test_trees_agree),         cmocka_unit_test(test_lights_agree),
        cmocka_unit_test(test_textures_agree), cmocka_unit_test(test_others_do_not_agree), cmocka_unit_test(test_bytes),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
