/* `soft` against what an area light does (tracer_shadow_area): nearer to it than any pcf, and wider with distance as it is. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "studio.h"
#include "trace/tracer.h"

static struct studio studio;

/* `truth` and `receiver` are malloc'd. */
static void area_truth(const struct set *set, const struct shot *shot, float **truth, uint8_t **receiver)
{
    struct error err = {0};
    struct view view = view_from_camera(&set->settings.camera, shot->width, shot->height);
    const struct light *light = &set->settings.lights[0];
    struct tracer *tracer = tracer_create(set->scene, 2, &err);
    assert_non_null(tracer);
    shot_truth(&studio, set, shot, 0, truth, receiver);
    assert_true(tracer_shadow_area(tracer, &view, light, tracer_area_radius(set->scene, light), 256, shot->ids, *receiver,
                                   studio.pool, NULL, NULL, *truth));
    tracer_destroy(tracer);
}

static double rmse(const struct shot *shot, const float *truth, const uint8_t *receiver)
{
    double sum = 0, count = 0;
    for (size_t i = 0; i < (size_t)shot->width * shot->height; i++) {
        double d = receiver[i] ? (double)shot->visibility[0][i] - (double)truth[i] : 0;
        sum += d * d;
        count += receiver[i];
    }
    assert_true(count > 1000);
    return sqrt(sum / count);
}

static void test_nearer_to_an_area_light_than_pcf(void **state)
{
    (void)state;
    static const char *const others[] = {"pcf:kernel=3", "pcf:kernel=5",  "pcf:kernel=7",
                                         "pcf:kernel=9", "pcf:kernel=15", "pcf:kernel=31"};
    struct set set = set_load(&studio, "builtin:contact");
    set.settings.width = 240;
    set.settings.height = 136;
    set_use(&set, "soft");
    struct shot soft = shot_take(&studio, &set);
    float *truth;
    uint8_t *receiver;
    area_truth(&set, &soft, &truth, &receiver);
    double mine = rmse(&soft, truth, receiver);
    assert_true(mine > 0);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        set_use(&set, others[i]);
        struct shot pcf = shot_take(&studio, &set);
        double theirs = rmse(&pcf, truth, receiver);
        if (!(mine < 0.6 * theirs))
            fail_msg("rmse %g of soft, %g of %s", mine, theirs, others[i]);
        shot_drop(&pcf);
    }
    free(truth);
    free(receiver);
    shot_drop(&soft);
    set_strike(&set);
}

/* Straight down on x in [-4, 4], z in [-0.6, 0.6]. */
static struct camera above(void)
{
    return (struct camera){.orthographic = true,
                           .eye = {0, 9, 0},
                           .right = {1, 0, 0},
                           .up = {0, 0, -1},
                           .back = {0, 1, 0},
                           .ymag = 0.6,
                           .near = 0.1,
                           .far = 20};
}

/* Where the row's values between pixels `from` and `to` last pass `level` of the way from their least to their most. */
static double crossing(const float *row, int from, int to, double level)
{
    double least = 1, most = 0, at = NAN;
    for (int i = from; i < to; i++) {
        least = fmin(least, (double)row[i]);
        most = fmax(most, (double)row[i]);
    }
    level = least + level * (most - least);
    for (int i = from; i + 1 < to; i++) {
        double a = (double)row[i] - level, b = (double)row[i + 1] - level;
        if ((a < 0) != (b < 0))
            at = i + a / (a - b);
    }
    return at;
}

static double width_of(const float *row, int from, int to)
{
    return fabs(crossing(row, from, to, 0.9) - crossing(row, from, to, 0.1));
}

/* The left edge of the low plate's shadow lies at x = -0.733, the right one of the high plate's at x = 2.6. */
static void test_penumbra_grows_with_distance(void **state)
{
    (void)state;
    const int wide = 800, row = 60;
    struct set set = set_load(&studio, "builtin:contact");
    set.settings.width = (uint32_t)wide;
    set.settings.height = 120;
    set.settings.camera = above();
    set_use(&set, "soft");
    struct shot shot = shot_take(&studio, &set);
    float *truth;
    uint8_t *receiver;
    area_truth(&set, &shot, &truth, &receiver);
    double soft[2], area[2];
    const int from[2] = {310, 600}, to[2] = {338, 730};
    for (int i = 0; i < 2; i++) {
        soft[i] = width_of(shot.visibility[0] + row * wide, from[i], to[i]);
        area[i] = width_of(truth + row * wide, from[i], to[i]);
        print_message("10 to 90 %% in %g pixels, of an area light in %g\n", soft[i], area[i]);
        assert_true(soft[i] > 0.7 * area[i] && soft[i] < 1.5 * area[i]);
    }
    assert_true(soft[1] > 3 * soft[0]);
    free(truth);
    free(receiver);
    shot_drop(&shot);
    set_strike(&set);
}

/* What the blur's guide is for: a lit surface in front of a dark one keeps its light, edge and all. */
static void test_receivers_do_not_bleed(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:contact");
    set.settings.width = 320;
    set.settings.height = 180;
    set_use(&set, "soft:lift=0");
    struct shot shot = shot_take(&studio, &set);
    size_t checked = 0, beside = 0;
    const uint32_t plates = 2 + 12; /* after the floor and the box */
    for (uint32_t y = 1; y < shot.height - 1; y++)
        for (uint32_t x = 1; x < shot.width - 1; x++) {
            size_t i = y * shot.width + x;
            if (shot.ids[i] == SCENE_NONE || shot.ids[i] < plates)
                continue;
            checked++;
            beside += shot.ids[i + shot.width] < 2 && shot.visibility[0][i + shot.width] < 0.2f;
            assert_true(shot.visibility[0][i] > 0.99f);
        }
    assert_true(checked > 500 && beside > 20);
    shot_drop(&shot);
    set_strike(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nearer_to_an_area_light_than_pcf),
        cmocka_unit_test(test_penumbra_grows_with_distance),
        cmocka_unit_test(test_receivers_do_not_bleed),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
