/* `mask` against the 32-sample truth: where one facet is all that a pixel shows, it errs far less than a plain map. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "reference/reference.h"
#include "studio.h"

static struct studio studio;

struct truth {
    uint32_t *receivers, *lit;
    uint8_t *one_triangle;
};

static struct truth find_truth(const struct set *set)
{
    struct error err = {0};
    size_t pixels = (size_t)set->settings.width * set->settings.height;
    struct view view = view_from_camera(&set->settings.camera, set->settings.width, set->settings.height);
    struct truth t = {calloc(pixels, 4), calloc(pixels, 4), calloc(pixels, 1)};
    struct reference *reference = reference_create(set->scene, 2, &err);
    assert_true(t.receivers && t.lit && t.one_triangle && reference);
    assert_true(reference_samples32(reference, &view, &set->settings.lights[0], studio.pool, NULL, t.receivers, t.lit,
                                    t.one_triangle, NULL));
    reference_destroy(reference);
    return t;
}

static void drop_truth(struct truth *t)
{
    free(t->receivers);
    free(t->lit);
    free(t->one_triangle);
}

/* Over all receivers, or those whose samples all see one triangle within the light's reach. */
static double rmse(struct set *set, const char *algorithm, const struct truth *t, bool one_triangle)
{
    set_use(set, algorithm);
    struct shot shot = shot_take(&studio, set);
    double sum = 0, count = 0;
    for (size_t i = 0; i < (size_t)shot.width * shot.height; i++) {
        if (!t->receivers[i] || (one_triangle && (!t->one_triangle[i] || t->receivers[i] != UINT32_MAX)))
            continue;
        double v = (double)__builtin_popcount(t->lit[i]) / __builtin_popcount(t->receivers[i]);
        sum += (v - (double)shot.visibility[0][i]) * (v - (double)shot.visibility[0][i]);
        count++;
    }
    assert_true(count > 1000);
    shot_drop(&shot);
    return sqrt(sum / count);
}

static void test_one_facet_is_nearly_right(void **state)
{
    (void)state;
    static const char *const names[] = {"builtin:box", "builtin:ball", "builtin:hard-20-twosided"};
    for (size_t k = 0; k < 3; k++) {
        struct set set = set_load(&studio, names[k]);
        set.settings.width = 240;
        set.settings.height = 136;
        struct truth t = find_truth(&set);
        double one[3], all[3];
        const char *const systems[3] = {"mask", "pcf", "sm"};
        for (int i = 0; i < 3; i++) {
            one[i] = rmse(&set, systems[i], &t, true);
            all[i] = rmse(&set, systems[i], &t, false);
        }
        print_message("%s: one triangle %.5f %.5f %.5f, all %.5f %.5f %.5f\n", names[k], one[0], one[1], one[2], all[0], all[1],
                      all[2]);
        assert_true(one[0] < one[1] / 2 && one[0] < one[2] / 3);
        assert_true(all[0] < all[2]);
        drop_truth(&t);
        set_strike(&set);
    }
}

/* Each light kind and camera, and a map of cube faces. */
static void test_kinds_of_light_and_camera(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:box");
    set.settings.width = 160;
    set.settings.height = 90;
    struct light spot = set.settings.lights[0], sun = spot;
    spot.kind = LIGHT_SPOT;
    spot.direction = dvec3_normalize(dvec3_neg(spot.position));
    spot.outer = 0.6;
    sun.kind = LIGHT_DIRECTIONAL;
    sun.direction = dvec3_normalize(dvec3(-0.3, -1, -0.2));
    const struct light lights[] = {set.settings.lights[0], spot, sun};
    for (int k = 0; k < 6; k++) {
        set.settings.lights[0] = lights[k % 3];
        set.settings.camera.orthographic = k >= 3;
        set.settings.camera.ymag = 1.6;
        set.settings.camera.far = 100;
        struct truth t = find_truth(&set);
        double mine = rmse(&set, k == 0 ? "mask:fit=cube" : "mask", &t, true), plain = rmse(&set, "sm", &t, true);
        if (!(mine < plain / 3))
            fail_msg("light %d, camera %d: rmse %g, %g of sm", k % 3, k / 3, mine, plain);
        drop_truth(&t);
    }
    set_strike(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_facet_is_nearly_right),
        cmocka_unit_test(test_kinds_of_light_and_camera),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
