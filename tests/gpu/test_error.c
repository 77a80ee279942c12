/* Errors of every shadow system against ray tracing (reference_point over the same ids), held under bounds.def; and what the
 * hard scenes promise in their comments. */
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
#include "reference/metrics.h"
#include "reference/reference.h"
#include "studio.h"

static struct studio studio;

static const struct bound {
    const char *scene, *system;
    unsigned long long misclassified, leaks, acne; /* pixels */
    double rmse;
} bounds[] = {
#define BOUND(scene, system, misclassified, leaks, acne, rmse) {scene, system, misclassified, leaks, acne, rmse},
#include "bounds.def"
#undef BOUND
};

static const struct measured_scene {
    const char *name;
    uint32_t width, height;
} scenes[] = {{"box", 160, 90},
              {"ball", 160, 90},
              {"tree", 160, 90},
              {"butterfly", 160, 90},
              {"dragon:triangles=20000", 160, 90},
              {"hard-01-grazing", 160, 90},
              {"hard-02-plane", 96, 54},
              {"hard-03-sliver", 96, 54},
              {"hard-04-contact", 160, 90},
              {"hard-05-noise", 96, 54},
              {"hard-06-fan", 160, 90},
              {"hard-07-tjunction", 96, 54},
              {"hard-08-depth", 160, 90},
              {"hard-09-thin", 96, 54},
              {"hard-10-duplicate", 96, 54},
              {"hard-11-degenerate", 160, 90},
              {"hard-12-behind", 96, 54},
              {"hard-13-near", 96, 54},
              {"hard-14-far", 96, 54},
              {"hard-15-offset", 96, 54},
              {"hard-16-scale", 96, 54},
              {"hard-17-ratio", 96, 54},
              {"hard-18-seams", 96, 54},
              {"hard-19-cards", 96, 54},
              {"hard-20-twosided", 160, 90},
              {"hard-21-grid", 64, 64},
              {"hard-22-million", 96, 54},
              {"hard-23-facets", 96, 54},
              {"hard-24-clipped", 96, 54},
              {"hard-25-sheets", 96, 54}};

static struct set load(const char *name, uint32_t width, uint32_t height)
{
    char full[80];
    snprintf(full, sizeof full, "builtin:%s", name);
    struct set set = set_load(&studio, full);
    set.settings.width = width;
    set.settings.height = height;
    return set;
}

static struct metrics compare(const struct shot *shot, const float *truth, const uint8_t *receiver)
{
    struct metrics m;
    const struct metrics_input in = {.width = shot->width,
                                     .height = shot->height,
                                     .visibility = shot->visibility[0],
                                     .reference = truth,
                                     .receiver = receiver};
    assert_true(metrics_measure(&in, &m));
    return m;
}

static const struct bound *find_bound(const char *scene, const char *system)
{
    for (size_t i = 0; i < sizeof bounds / sizeof bounds[0]; i++)
        if (strcmp(bounds[i].scene, scene) == 0 && strcmp(bounds[i].system, system) == 0)
            return &bounds[i];
    return NULL;
}

/* 1.3 times what is measured, and a little: room for another driver's rounding, none for a regression. */
static unsigned long long room(uint64_t pixels) { return (unsigned long long)(1.3 * (double)pixels) + 2; }

static void print_bound(const char *scene, const char *system, const struct metrics *m)
{
    printf("BOUND(\"%s\", \"%s\", %llu, %llu, %llu, %.4f) /* %llu, %llu, %llu, %.5f of %llu receivers */\n", scene, system,
           room(m->misclassified), room(m->leaks), room(m->acne), 1.3 * m->rmse + 0.002, (unsigned long long)m->misclassified,
           (unsigned long long)m->leaks, (unsigned long long)m->acne, m->rmse, (unsigned long long)m->receivers);
}

/* Returns the number of bounds broken, having told of each. */
static int check_bound(const char *scene, const struct shadow_system *system, const struct metrics *m)
{
    const struct bound *b = find_bound(scene, system->name);
    if (getenv("GNOMON_PRINT_BOUNDS") && !(system->flags & SHADOW_EXACT))
        print_bound(scene, system->name, m);
    if (system->flags & SHADOW_EXACT) {
        if (m->rmse == 0 && m->max_abs == 0 && m->misclassified == 0)
            return 0;
        print_error("%s on %s: promises the truth, %llu pixels differ, rmse %g\n", system->name, scene,
                    (unsigned long long)m->misclassified, m->rmse);
        return 1;
    }
    if (!b) {
        print_error("%s on %s: bounds.def has no line for it\n", system->name, scene);
        return 1;
    }
    if (m->misclassified <= b->misclassified && m->leaks <= b->leaks && m->acne <= b->acne && m->rmse <= b->rmse)
        return 0;
    print_error("%s on %s: misclassified %llu (at most %llu), leaks %llu (%llu), acne %llu (%llu), rmse %.5f (%.5f)\n",
                system->name, scene, (unsigned long long)m->misclassified, b->misclassified, (unsigned long long)m->leaks,
                b->leaks, (unsigned long long)m->acne, b->acne, m->rmse, b->rmse);
    return 1;
}

static void test_errors_stay_within_bounds(void **state)
{
    (void)state;
    int broken = 0;
    for (size_t k = 0; k < sizeof scenes / sizeof scenes[0]; k++) {
        struct set set = load(scenes[k].name, scenes[k].width, scenes[k].height);
        float *truth = NULL;
        uint8_t *receiver = NULL;
        for (size_t i = 0; i < shadow_system_count; i++) {
            set.settings.system = shadow_systems[i];
            set.settings.params = shadow_defaults(shadow_systems[i]);
            struct shot shot = shot_take(&studio, &set);
            if (!truth)
                shot_truth(&studio, &set, &shot, 0, &truth, &receiver);
            struct metrics m = compare(&shot, truth, receiver);
            assert_true(m.receivers > 1000);
            broken += check_bound(scenes[k].name, shadow_systems[i], &m);
            shot_drop(&shot);
        }
        free(receiver);
        free(truth);
        set_strike(&set);
    }
    assert_int_equal(broken, 0);
}

/* A line of a system or scene that is gone would hold nobody. */
static void test_every_bound_is_used(void **state)
{
    (void)state;
    for (size_t b = 0; b < sizeof bounds / sizeof bounds[0]; b++) {
        bool scene = false;
        for (size_t k = 0; k < sizeof scenes / sizeof scenes[0]; k++)
            scene |= strcmp(scenes[k].name, bounds[b].scene) == 0;
        if (!scene || !shadow_find(bounds[b].system, strlen(bounds[b].system)))
            fail_msg("bounds.def: nobody measures %s on %s", bounds[b].system, bounds[b].scene);
        assert_true(find_bound(bounds[b].scene, bounds[b].system) == &bounds[b]);
    }
}

/* samples=32 is the 32-sample truth itself. */
static void test_reference_samples_equal_samples32(void **state)
{
    (void)state;
    static const char *const names[] = {"box", "hard-11-degenerate", "hard-20-twosided"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        struct error err = {0};
        struct set set = load(names[k], 96, 54);
        set_use(&set, "reference:samples=32");
        struct shot shot = shot_take(&studio, &set);
        struct view view = view_from_camera(&set.settings.camera, shot.width, shot.height);
        size_t pixels = (size_t)shot.width * shot.height;
        uint32_t *receivers = calloc(pixels, sizeof *receivers), *lit = calloc(pixels, sizeof *lit);
        struct reference *reference = reference_create(set.scene, 2, &err);
        assert_true(reference && receivers && lit);
        assert_true(
            reference_samples32(reference, &view, &set.settings.lights[0], studio.pool, NULL, receivers, lit, NULL, NULL));
        size_t between = 0;
        for (size_t i = 0; i < pixels; i++) {
            int n = __builtin_popcount(receivers[i]);
            float v = n ? (float)__builtin_popcount(lit[i]) / (float)n : 0;
            assert_true(shot.visibility[0][i] == v);
            between += v > 0 && v < 1;
        }
        assert_true(between > 20);
        reference_destroy(reference);
        free(lit);
        free(receivers);
        shot_drop(&shot);
        set_strike(&set);
    }
}

/* hard-11: the bad triangles change nothing in any system's picture. */
static void test_degenerate_triangles_change_nothing(void **state)
{
    (void)state;
    struct set with = load("hard-11-degenerate:bad=1", 160, 90), without = load("hard-11-degenerate:bad=0", 160, 90);
    for (int traced = 0; traced < 2; traced++)
        for (size_t i = 0; i < shadow_system_count; i++) {
            struct set *sets[] = {&with, &without};
            struct shot shots[2];
            for (int k = 0; k < 2; k++) {
                sets[k]->settings.camera_pass = sets[k]->settings.map_pass = traced ? CAMERA_PASS_TRACED : CAMERA_PASS_RASTER;
                sets[k]->settings.system = shadow_systems[i];
                sets[k]->settings.params = shadow_defaults(shadow_systems[i]);
                shots[k] = shot_take(&studio, sets[k]);
            }
            if (memcmp(shots[0].pixels, shots[1].pixels, shots[0].size) != 0)
                fail_msg("%s, %s: degenerate triangles change the picture", shadow_systems[i]->name,
                         traced ? "traced" : "rasterized");
            shot_drop(&shots[0]);
            shot_drop(&shots[1]);
        }
    set_strike(&without);
    set_strike(&with);
}

/* hard-21: where each shadow on the floor lies, in pixels, and how many of them it darkens. */
static void test_grid_has_exactly_its_dark_pixels(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        int x0, y0, x1, y1; /* up to, not with, x1 and y1 */
        int dark;
    } shadows[] = {
        {"a square", 4, 10, 18, 20, 6 * 6},
        {"two squares whose shadows share an edge", 20, 10, 36, 20, 8 * 6},
        {"half a square", 44, 10, 60, 20, 6 + 5 + 4 + 3 + 2 + 1},
        {"a triangle with slopes of 1/2", 4, 31, 16, 40, 2 + 4 + 6 + 4 + 2},
        {"a fan of eight", 20, 33, 36, 44, 8 * 8},
        {"units corner to corner", 43, 31, 56, 40, 5},
        {"a sheet along the light", 0, 42, 20, 60, 0},
        {"a sheet across it", 24, 46, 40, 52, 6 * 4},
        {"all", 0, 0, 64, 64, 36 + 48 + 21 + 18 + 64 + 5 + 24},
    };
    struct set set = load("hard-21-grid", 64, 64);
    for (size_t i = 0; i < shadow_system_count; i++) {
        if (!(shadow_systems[i]->flags & SHADOW_EXACT))
            continue;
        set.settings.system = shadow_systems[i];
        set.settings.params = shadow_defaults(shadow_systems[i]);
        struct shot shot = shot_take(&studio, &set);
        for (size_t k = 0; k < sizeof shadows / sizeof shadows[0]; k++) {
            int dark = 0;
            for (int y = shadows[k].y0; y < shadows[k].y1; y++)
                for (int x = shadows[k].x0; x < shadows[k].x1; x++)
                    dark += shot.ids[y * 64 + x] < 2 && shot.visibility[0][y * 64 + x] == 0;
            if (dark != shadows[k].dark)
                fail_msg("%s: %s has %d dark pixels, not %d", shadow_systems[i]->name, shadows[k].what, dark, shadows[k].dark);
        }
        shot_drop(&shot);
    }
    set_strike(&set);
}

/* Whether the segment from `p` to `q` passes through the inside of a box by more than `skin`. */
static bool crosses_box(struct dvec3 p, struct dvec3 q, const struct dbox *box, double skin)
{
    const double from[3] = {p.x, p.y, p.z}, to[3] = {q.x, q.y, q.z};
    const double low[3] = {box->min.x, box->min.y, box->min.z}, high[3] = {box->max.x, box->max.y, box->max.z};
    double enter = 0, leave = 1;
    for (int k = 0; k < 3; k++) {
        double d = to[k] - from[k], a = (low[k] + skin - from[k]) / d, b = (high[k] - skin - from[k]) / d;
        enter = fmax(enter, fmin(a, b));
        leave = fmin(leave, fmax(a, b));
    }
    return enter < leave;
}

/* hard-04: the shadow of the box that stands straight, by geometry: dark from its very foot on. */
static void test_contact_shadow_starts_at_the_foot(void **state)
{
    (void)state;
    static const struct dbox box = {{-1, 0, -0.25}, {-0.5, 0.5, 0.25}};
    struct set set = load("hard-04-contact", 640, 360);
    const struct light *light = &set.settings.lights[0];
    /* From where the shadow falls. */
    set.settings.camera = made_camera(dvec3(-2.5, 1.2, -1.5), dvec3(-0.9, 0, -0.2), 0.6);
    struct view view = view_from_camera(&set.settings.camera, 640, 360);
    for (size_t i = 0; i < shadow_system_count; i++) {
        if (!(shadow_systems[i]->flags & SHADOW_EXACT))
            continue;
        set.settings.system = shadow_systems[i];
        set.settings.params = shadow_defaults(shadow_systems[i]);
        struct shot shot = shot_take(&studio, &set);
        int in_shadow = 0, at_foot = 0;
        for (int pixel = 0; pixel < 640 * 360; pixel++) {
            struct dvec3 o, d;
            view_ray(&view, pixel % 640 + 0.5, pixel / 640 + 0.5, &o, &d);
            struct dvec3 p = dvec3_mad(o, d, -o.y / d.y);
            if (shot.ids[pixel] != 0 && shot.ids[pixel] != 1)
                continue;
            p.y = 0;
            if (!crosses_box(p, light->position, &box, 1e-9))
                continue;
            in_shadow++;
            at_foot += p.x > -1.01 && p.x < -0.49 && p.z > -0.26 && p.z < 0.26;
            if (shot.visibility[0][pixel] != 0)
                fail_msg("%s: light under the box at %g, %g", shadow_systems[i]->name, p.x, p.z);
        }
        assert_true(in_shadow > 500 && at_foot > 10);
        shot_drop(&shot);
    }
    set_strike(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_errors_stay_within_bounds),         cmocka_unit_test(test_every_bound_is_used),
        cmocka_unit_test(test_reference_samples_equal_samples32), cmocka_unit_test(test_degenerate_triangles_change_nothing),
        cmocka_unit_test(test_grid_has_exactly_its_dark_pixels),  cmocka_unit_test(test_contact_shadow_starts_at_the_foot),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
