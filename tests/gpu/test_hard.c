/* The hard cases, every one: systems that promise the truth give it, for one sample and for each of 32. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "builtin/builtin.h"
#include "reference/reference.h"
#include "studio.h"

enum { WIDTH = 64, HEIGHT = 36 };

static struct studio studio;

static bool is_hard(const struct builtin_desc *desc) { return strncmp(desc->name, "hard-", 5) == 0; }

static struct set load(const struct builtin_desc *desc)
{
    char name[80];
    snprintf(name, sizeof name, "builtin:%s", desc->name);
    struct set set = set_load(&studio, name);
    set.settings.width = WIDTH;
    set.settings.height = HEIGHT;
    return set;
}

/* V of `samples32`, malloc'd. */
static float *true_shares(const struct set *set)
{
    struct error err = {0};
    const size_t pixels = WIDTH * HEIGHT;
    struct view view = view_from_camera(&set->settings.camera, WIDTH, HEIGHT);
    uint32_t *receivers = calloc(pixels, sizeof *receivers), *lit = calloc(pixels, sizeof *lit);
    float *shares = calloc(pixels, sizeof *shares);
    struct reference *reference = reference_create(set->scene, 2, &err);
    assert_true(reference && receivers && lit && shares);
    assert_true(reference_samples32(reference, &view, &set->settings.lights[0], studio.pool, NULL, receivers, lit, NULL, NULL));
    for (size_t i = 0; i < pixels; i++) {
        int n = __builtin_popcount(receivers[i]);
        shares[i] = n ? (float)__builtin_popcount(lit[i]) / (float)n : 0;
    }
    reference_destroy(reference);
    free(lit);
    free(receivers);
    return shares;
}

static size_t count_wrong(const float *visibility, const float *truth)
{
    size_t wrong = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        wrong += visibility[i] != truth[i];
    return wrong;
}

static bool takes_samples(const struct shadow_system *system)
{
    return (system->flags & SHADOW_EXACT) && shadow_param_index(system, "samples") >= 0;
}

static struct shot take(struct set *set, const struct shadow_system *system, const char *samples)
{
    struct error err = {0};
    set->settings.system = system;
    set->settings.params = shadow_defaults(system);
    assert_true(shadow_param_parse(system, &set->settings.params, "samples", samples, &err));
    return shot_take(&studio, set);
}

static void check_scene(const struct builtin_desc *desc)
{
    struct set set = load(desc);
    float *shares = true_shares(&set), *truth = NULL;
    uint8_t *receiver = NULL;
    for (size_t i = 0; i < shadow_system_count; i++) {
        if (!takes_samples(shadow_systems[i]))
            continue;
        struct shot one = take(&set, shadow_systems[i], "1"), many = take(&set, shadow_systems[i], "32");
        if (!truth)
            shot_truth(&studio, &set, &one, 0, &truth, &receiver);
        size_t wrong = count_wrong(one.visibility[0], truth), wrong_many = count_wrong(many.visibility[0], shares);
        if (wrong || wrong_many)
            fail_msg("%s on %s: %zu pixels wrong for one sample, %zu for 32", shadow_systems[i]->name, desc->name, wrong,
                     wrong_many);
        shot_drop(&many);
        shot_drop(&one);
    }
    free(receiver);
    free(truth);
    free(shares);
    set_strike(&set);
}

static void test_truth_on_every_hard_case(void **state)
{
    (void)state;
    size_t cases = 0;
    for (size_t i = 0; i < builtin_count; i++)
        if (is_hard(builtin_list[i])) {
            check_scene(builtin_list[i]);
            cases++;
        }
    assert_int_equal(cases, 25);
}

/* A system of plain depth is wrong somewhere: the count above can be more than 0. */
static void test_the_count_can_fail(void **state)
{
    (void)state;
    for (size_t i = 0; i < builtin_count; i++)
        if (strcmp(builtin_list[i]->name, "hard-08-depth") == 0) {
            struct set set = load(builtin_list[i]);
            float *shares = true_shares(&set);
            set_use(&set, "sm");
            struct shot shot = shot_take(&studio, &set);
            assert_true(count_wrong(shot.visibility[0], shares) > 20);
            shot_drop(&shot);
            free(shares);
            set_strike(&set);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_truth_on_every_hard_case),
        cmocka_unit_test(test_the_count_can_fail),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
