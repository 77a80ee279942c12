/* Lighting by shaders and on the CPU, the visibility the same bits: the same picture, but for roundings. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "studio.h"

static struct studio studio;

struct difference {
    int largest;  /* of a channel, of 255 */
    double share; /* of the channels that differ at all */
};

static struct difference difference_of(const struct shot *a, const struct shot *b)
{
    struct difference d = {0};
    for (size_t i = 0; i < a->size; i++) {
        int step = abs(a->pixels[i] - b->pixels[i]);
        d.largest = step > d.largest ? step : d.largest;
        d.share += step > 0;
    }
    d.share /= (double)a->size;
    return d;
}

static struct difference compare(struct set *set)
{
    set->settings.resolve_pass = RESOLVE_PASS_GPU;
    struct shot gpu = shot_take(&studio, set);
    set->settings.resolve_pass = RESOLVE_PASS_CPU;
    struct shot cpu = shot_take(&studio, set);
    assert_int_equal(gpu.size, cpu.size);
    struct difference d = difference_of(&gpu, &cpu);
    shot_drop(&gpu);
    shot_drop(&cpu);
    return d;
}

static void check(struct set *set, const char *what)
{
    struct difference d = compare(set);
    if (d.largest > 1 || d.share > 0.01)
        fail_msg("%s: steps of %d, %g of the channels differ", what, d.largest, d.share);
}

static struct set load(const char *name)
{
    struct set set = set_load(&studio, name);
    set_use(&set, "exact:samples=32");
    set.settings.width = 187; /* no multiple of eight */
    set.settings.height = 107;
    set.settings.camera_pass = CAMERA_PASS_TRACED;
    return set;
}

static void test_scenes_agree(void **state)
{
    (void)state;
    static const char *const names[] = {"builtin:box", "builtin:tree", "builtin:ball", "builtin:contact"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct set set = load(names[i]);
        check(&set, names[i]);
        set.settings.camera_pass = CAMERA_PASS_RASTER;
        check(&set, "rasterized");
        set.settings.tonemap = TONEMAP_NONE;
        set.settings.exposure_auto = false;
        set.settings.exposure_ev = -6;
        check(&set, "without a tone curve");
        set_strike(&set);
    }
}

static void test_lights_agree(void **state)
{
    (void)state;
    struct set set = load("builtin:box");
    struct light point = set.settings.lights[0], spot = point, sun = point;
    point.kind = LIGHT_POINT;
    point.range = 12;
    spot.kind = LIGHT_SPOT;
    spot.direction = dvec3(0, -1, 0);
    spot.inner = 0.2;
    spot.outer = 0.6;
    sun.kind = LIGHT_DIRECTIONAL;
    sun.direction = dvec3(0, -1, 0);
    sun.color[0] = 0.2f;
    const struct light all[] = {point, spot, sun};
    for (size_t i = 0; i < 3; i++) {
        set.settings.lights[0] = all[i];
        set.settings.light_count = 1;
        check(&set, "one light");
    }
    memcpy(set.settings.lights, all, sizeof all);
    set.settings.light_count = 3;
    check(&set, "three kinds of light");
    set.settings.light_count = 0;
    check(&set, "no light");
    set_strike(&set);
}

/* What the CPU does not do goes the other way, with visibility that lies there. */
static void test_the_rest_is_left_to_shaders(void **state)
{
    (void)state;
    struct set set = load("builtin:tree");
    for (int show = SHOW_VISIBILITY; show <= SHOW_ID; show++) {
        set.settings.show = (enum show)show;
        struct difference d = compare(&set);
        assert_int_equal(d.largest, 0);
    }
    set.settings.show = SHOW_SHADED;
    set.settings.aa = 4;
    assert_int_equal(compare(&set).largest, 0);
    set_strike(&set);
}

static void test_another_exposure_is_found(void **state)
{
    (void)state;
    struct set set = load("builtin:box");
    set.settings.resolve_pass = RESOLVE_PASS_GPU;
    struct shot gpu = shot_take(&studio, &set);
    set.settings.resolve_pass = RESOLVE_PASS_CPU;
    set.settings.ambient *= 1.2;
    struct shot cpu = shot_take(&studio, &set);
    struct difference d = difference_of(&gpu, &cpu);
    assert_true(d.largest > 1 && d.share > 0.01);
    shot_drop(&gpu);
    shot_drop(&cpu);
    set_strike(&set);
}

int main(void)
{
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scenes_agree),
        cmocka_unit_test(test_lights_agree),
        cmocka_unit_test(test_the_rest_is_left_to_shaders),
        cmocka_unit_test(test_another_exposure_is_found),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
