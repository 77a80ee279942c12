/* What every shadow system must keep. Loops over the registry and names none: a new system is tested by being registered. */
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
#include "reference/reference.h"
#include "studio.h"

static struct studio studio;

/* Maps larger than this only slow the test down. */
#define SIZE_CAP 512

static const enum light_kind kinds[] = {LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPOT};

static void add_quad(struct scene *scene, struct dvec3 center, double half, uint32_t material)
{
    const float x = (float)center.x, y = (float)center.y, z = (float)center.z, h = (float)half;
    const float points[6][3] = {{x - h, y, z - h}, {x - h, y, z + h}, {x + h, y, z + h},
                                {x - h, y, z - h}, {x + h, y, z + h}, {x + h, y, z - h}};
    made_triangles(scene, points, 6, material);
}

/* An upright wall, so that not everything is a plane. */
static void add_wall(struct scene *scene, double x, uint32_t material)
{
    const float a = (float)x;
    const float points[6][3] = {{a, 0, -0.4f}, {a, 0, 0.4f}, {a, 0.9f, 0.4f}, {a, 0, -0.4f}, {a, 0.9f, 0.4f}, {a, 0.9f, -0.4f}};
    made_triangles(scene, points, 6, material);
}

enum stage_kind { BARE, SOME, COVERED };

/* A floor; with a wall and a small roof on it; or all of it under a large roof. */
static struct set make_stage(enum stage_kind what)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true);
    add_quad(scene, dvec3(0, 0, 0), 2, material);
    if (what == SOME) {
        add_wall(scene, -0.3, material);
        add_quad(scene, dvec3(0.6, 0.7, 0.2), 0.3, material);
    } else if (what == COVERED) {
        add_quad(scene, dvec3(0, 1.5, 0), 6, material);
    }
    made_finish(scene);
    struct set set = set_build(&studio, scene);
    set.settings.camera = made_camera(dvec3(0.3, what == COVERED ? 0.4 : 2.5, 2.2), dvec3(0, 0, 0), 0.8);
    return set;
}

static struct light light_of(enum light_kind kind)
{
    struct light light = made_light(kind, dvec3(0.9, 3, 0.7), dvec3(0, 0, 0));
    light.outer = 0.5;
    light.inner = 0.4;
    return light;
}

/* A system, its parameters (one of them moved to an end), a light kind. */
struct trial {
    const struct shadow_system *system;
    struct shadow_params params;
    enum light_kind kind;
    bool tolerance; /* a number that is not whole was moved: what it allows may be as large as the scene */
    char name[300];
};

static void run_trial(struct trial *t, void (*check)(const struct trial *trial))
{
    char text[256];
    shadow_format(t->system, &t->params, text, sizeof text);
    snprintf(t->name, sizeof t->name, "%s, light kind %d", text, (int)t->kind);
    check(t);
}

static double capped(const struct param_desc *p, double value)
{
    return p->kind == PARAM_INT && p->max > SIZE_CAP && value > SIZE_CAP ? SIZE_CAP : value;
}

static void run_params(const struct shadow_system *system, enum light_kind kind, void (*check)(const struct trial *trial))
{
    struct trial t = {.system = system, .params = shadow_defaults(system), .kind = kind};
    for (size_t i = 0; i < system->param_count; i++)
        t.params.value[i] = capped(&system->params[i], t.params.value[i]);
    const struct shadow_params initial = t.params;
    run_trial(&t, check);
    for (size_t i = 0; i < system->param_count; i++) {
        const struct param_desc *p = &system->params[i];
        const double ends[] = {p->min, p->max};
        for (int k = 0; k < 2; k++) {
            t.params = initial;
            t.params.value[i] = capped(p, ends[k]);
            t.tolerance = p->kind == PARAM_FLOAT;
            if (t.params.value[i] != initial.value[i])
                run_trial(&t, check);
        }
    }
}

static void run_all(void (*check)(const struct trial *trial))
{
    assert_true(shadow_system_count > 0);
    for (size_t i = 0; i < shadow_system_count; i++)
        for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
            if (shadow_systems[i]->lights & 1u << kinds[k])
                run_params(shadow_systems[i], kinds[k], check);
}

static void set_trial(struct set *set, const struct trial *t)
{
    set->settings.system = t->system;
    set->settings.params = t->params;
    set->settings.lights[0] = light_of(t->kind);
    set->settings.light_count = 1;
}

/* No surface at the pixel or beside it: samples away from the centre see none either. */
static bool is_background(const struct shot *shot, size_t pixel)
{
    int x = (int)(pixel % shot->width), y = (int)(pixel / shot->width);
    for (int j = y - 1; j <= y + 1; j++)
        for (int i = x - 1; i <= x + 1; i++)
            if (i >= 0 && j >= 0 && i < (int)shot->width && j < (int)shot->height &&
                shot->ids[j * (int)shot->width + i] != SCENE_NONE)
                return false;
    return true;
}

/* What holds of every answer whatever the scene. Returns the pixels with a surface. */
static size_t check_range(const struct shot *shot, const struct trial *t)
{
    size_t surfaces = 0;
    for (unsigned l = 0; l < shot->light_count; l++)
        for (size_t i = 0; i < (size_t)shot->width * shot->height; i++) {
            float v = shot->visibility[l][i];
            if (!(v >= 0 && v <= 1))
                fail_msg("%s: visibility %g at pixel %zu", t->name, v, i);
            if (v != 0 && is_background(shot, i))
                fail_msg("%s: visibility %g where there is no surface, pixel %zu", t->name, v, i);
            if (t->system->flags & SHADOW_BINARY && v != 0 && v != 1)
                fail_msg("%s: promises 0 or 1 and answers %g at pixel %zu", t->name, v, i);
            surfaces += l == 0 && shot->ids[i] != SCENE_NONE;
        }
    return surfaces;
}

static struct set some, bare, covered, other;

static void check_repeats(const struct trial *t)
{
    set_trial(&some, t);
    struct shot first = shot_take(&studio, &some), second = shot_take(&studio, &some);
    struct shot between = shot_take(&studio, &other);
    struct shot third = shot_take(&studio, &some);
    size_t surfaces = check_range(&first, t);
    assert_true(surfaces > 1000 && surfaces < (size_t)first.width * first.height);
    if (!shot_same(&first, &second))
        fail_msg("%s: the second picture differs", t->name);
    if (!shot_same(&first, &third))
        fail_msg("%s: the picture differs after another's", t->name);
    assert_true(first.info.prepared);
    assert_false(second.info.prepared);
    shot_drop(&first);
    shot_drop(&second);
    shot_drop(&between);
    shot_drop(&third);
}

static void test_answers_repeat(void **state)
{
    (void)state;
    some = make_stage(SOME);
    other = set_load(&studio, "builtin:hard-04-contact");
    run_all(check_repeats);
    set_strike(&other);
    set_strike(&some);
}

/* Pixels whose receivers are all lit (lit = 1) or all dark. */
static void check_constant(struct set *set, const struct trial *t, float lit)
{
    set_trial(set, t);
    float *truth;
    uint8_t *receiver;
    struct shot shot = shot_take(&studio, set);
    check_range(&shot, t);
    shot_truth(&studio, set, &shot, 0, &truth, &receiver);
    size_t receivers = 0;
    for (size_t i = 0; i < (size_t)shot.width * shot.height; i++) {
        if (!receiver[i])
            continue;
        receivers++;
        assert_true(truth[i] == lit);
        float v = shot.visibility[0][i];
        bool as_said = lit == 0 && t->system->flags & SHADOW_BRIGHTENS ? v < 0.5f : v == lit;
        if (!as_said)
            fail_msg("%s: visibility %g at pixel %zu, not %g", t->name, shot.visibility[0][i], i, lit);
    }
    assert_true(receivers > 1000);
    free(receiver);
    free(truth);
    shot_drop(&shot);
}

static void check_bare(const struct trial *t) { check_constant(&bare, t, 1); }

static void test_without_casters_all_is_lit(void **state)
{
    (void)state;
    bare = make_stage(BARE);
    run_all(check_bare);
    set_strike(&bare);
}

static void check_covered(const struct trial *t)
{
    if (!(t->system->flags & SHADOW_NO_SHADOWS) && !t->tolerance)
        check_constant(&covered, t, 0);
}

static void test_under_full_cover_all_is_dark(void **state)
{
    (void)state;
    covered = make_stage(COVERED);
    run_all(check_covered);
    set_strike(&covered);
}

static void check_exact_light(struct set *set, const struct shot *shot, const struct trial *t, unsigned light)
{
    float *truth;
    uint8_t *receiver;
    shot_truth(&studio, set, shot, light, &truth, &receiver);
    for (size_t i = 0; i < (size_t)shot->width * shot->height; i++)
        if (shot->visibility[light][i] != truth[i])
            fail_msg("%s: promises the truth and answers %g at pixel %zu, not %g", t->name, shot->visibility[light][i], i,
                     truth[i]);
    free(receiver);
    free(truth);
}

/* At its defaults: other parameters may ask another question (more samples) or a cheaper answer. */
static void test_exact_systems_equal_the_reference(void **state)
{
    (void)state;
    static const char *const scenes[] = {"builtin:box", "builtin:hard-04-contact", "builtin:hard-11-degenerate"};
    size_t exact = 0;
    for (size_t k = 0; k < sizeof scenes / sizeof scenes[0]; k++) {
        struct set set = set_load(&studio, scenes[k]);
        for (size_t i = 0; i < shadow_system_count; i++) {
            struct trial t = {.system = shadow_systems[i], .params = shadow_defaults(shadow_systems[i])};
            if (!(t.system->flags & SHADOW_EXACT))
                continue;
            exact++;
            snprintf(t.name, sizeof t.name, "%s on %s", t.system->name, scenes[k]);
            set.settings.system = t.system;
            set.settings.params = t.params;
            struct shot shot = shot_take(&studio, &set);
            check_exact_light(&set, &shot, &t, 0);
            shot_drop(&shot);
        }
        set_strike(&set);
    }
    assert_true(exact > 0);
}

struct errors {
    double rms, misclassified; /* the latter a fraction of the receivers */
};

/* The truth of 32 samples in place of the centre's, for pixels that show one triangle: what others share is not the map's doing. */
static void samples_truth(const struct set *set, const struct shot *shot, float *truth, uint8_t *receiver)
{
    struct error err = {0};
    struct view view = view_from_camera(&set->settings.camera, shot->width, shot->height);
    size_t pixels = (size_t)shot->width * shot->height;
    uint32_t *receivers = calloc(pixels, sizeof *receivers), *lit = calloc(pixels, sizeof *lit);
    struct reference *reference = reference_create(set->scene, 2, &err);
    uint8_t *one_triangle = calloc(pixels, 1);
    assert_true(receivers && lit && one_triangle && reference);
    assert_true(
        reference_samples32(reference, &view, &set->settings.lights[0], studio.pool, NULL, receivers, lit, one_triangle, NULL));
    for (size_t i = 0; i < pixels; i++) {
        int count = __builtin_popcount(receivers[i]);
        receiver[i] = count > 0 && one_triangle[i];
        truth[i] = count ? (float)__builtin_popcount(lit[i]) / (float)count : 0;
    }
    reference_destroy(reference);
    free(one_triangle);
    free(lit);
    free(receivers);
}

/* Against the samples that the system decides: the pixel's centre, or all 32. */
static struct errors measure(struct set *set, const struct shot *shot)
{
    float *truth;
    uint8_t *receiver;
    double sum = 0, wrong = 0, receivers = 0;
    const struct shadow_system *system = set->settings.system;
    shot_truth(&studio, set, shot, 0, &truth, &receiver);
    if (system->read_masks && !(system->flags & SHADOW_EXACT))
        samples_truth(set, shot, truth, receiver);
    for (size_t i = 0; i < (size_t)shot->width * shot->height; i++) {
        double d = receiver[i] ? fabs((double)shot->visibility[0][i] - (double)truth[i]) : 0;
        sum += d * d;
        wrong += d > 0.5;
        receivers += receiver[i];
    }
    free(receiver);
    free(truth);
    assert_true(receivers > 1000);
    return (struct errors){sqrt(sum / receivers), wrong / receivers};
}

/* Errors that do not come from the map's grain, such as a filter's, may stay. */
static void check_error_shrinks(const struct shadow_system *system, struct set *set, const char *what)
{
    int size = shadow_param_index(system, "size");
    assert_true(size >= 0);
    struct errors first = {0, 0}, last = {INFINITY, INFINITY};
    set->settings.system = system;
    set->settings.params = shadow_defaults(system);
    for (double side = 128; side <= 1024; side *= 2) {
        set->settings.params.value[size] = side;
        struct shot shot = shot_take(&studio, set);
        struct errors now = measure(set, &shot);
        assert_int_equal(shot.info.map_size, side);
        /* From step to step an edge may fall worse on the texels: a tenth. */
        if (now.rms > 1.1 * last.rms + 1e-3 || now.misclassified > 1.1 * last.misclassified + 2e-4)
            fail_msg("%s, %s: errors grow to %g rms, %g misclassified at size %g, from %g and %g", system->name, what, now.rms,
                     now.misclassified, side, last.rms, last.misclassified);
        first = side == 128 ? now : first;
        last = now;
        shot_drop(&shot);
    }
    /* Who has next to nothing wrong at any size cannot improve: a point may lie on an edge to within rounding. */
    if (last.misclassified > 2e-4 && !(last.misclassified < 0.6 * first.misclassified))
        fail_msg("%s, %s: %g misclassified at size 128 and no fewer than %g at 1024", system->name, what, first.misclassified,
                 last.misclassified);
}

static void test_errors_shrink_with_size(void **state)
{
    (void)state;
    struct set set = set_load(&studio, "builtin:box");
    set.settings.width = 160;
    set.settings.height = 120;
    struct camera perspective = set.settings.camera, orthographic = perspective;
    orthographic.orthographic = true;
    orthographic.ymag = 1.6;
    orthographic.far = 100;
    for (size_t i = 0; i < shadow_system_count; i++) {
        if (!(shadow_systems[i]->flags & SHADOW_USES_MAPS))
            continue;
        set.settings.camera = perspective;
        check_error_shrinks(shadow_systems[i], &set, "perspective camera");
        set.settings.camera = orthographic;
        check_error_shrinks(shadow_systems[i], &set, "orthographic camera");
    }
    set_strike(&set);
}

/* Each light of many answers as it does alone. */
static void test_lights_do_not_mix(void **state)
{
    (void)state;
    struct set set = make_stage(SOME);
    struct light lights[3];
    for (int k = 0; k < 3; k++)
        lights[k] = light_of(kinds[k]);
    for (size_t i = 0; i < shadow_system_count; i++) {
        struct shot alone[3];
        size_t count = 0;
        struct trial t = {.system = shadow_systems[i], .params = shadow_defaults(shadow_systems[i])};
        snprintf(t.name, sizeof t.name, "%s, several lights", t.system->name);
        set.settings.system = t.system;
        set.settings.params = t.params;
        for (int k = 0; k < 3; k++)
            if (t.system->lights & 1u << kinds[k]) {
                set.settings.lights[0] = lights[k];
                set.settings.light_count = 1;
                alone[count++] = shot_take(&studio, &set);
            }
        for (size_t k = 0, n = 0; k < 3; k++)
            if (t.system->lights & 1u << kinds[k])
                set.settings.lights[n++] = lights[k];
        set.settings.light_count = count;
        struct shot together = shot_take(&studio, &set);
        check_range(&together, &t);
        for (size_t k = 0; k < count; k++) {
            size_t bytes = (size_t)together.width * together.height * sizeof(float);
            if (memcmp(together.visibility[k], alone[k].visibility[0], bytes) != 0)
                fail_msg("%s: light %zu of %zu answers otherwise than alone", t.name, k, count);
            shot_drop(&alone[k]);
        }
        shot_drop(&together);
    }
    set_strike(&set);
}

/* A masked roof over a floor: 4 x 4 squares like a chess board. */
static struct set make_masked(bool holes)
{
    struct scene *scene = made_scene();
    uint32_t plain = made_material(scene, true), masked = made_material(scene, true);
    uint8_t solid[16];
    for (int i = 0; i < 16; i++)
        solid[i] = !holes || ((i ^ i >> 2) & 1);
    made_mask(scene, masked, 4, solid);
    add_quad(scene, dvec3(0, 0, 0), 2, plain);
    const float points[4][3] = {{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}};
    const float uv[4][2] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    made_instance(scene, made_mesh(scene, points, uv, 4, indices, 6, masked), affine_identity());
    made_finish(scene);
    struct set set = set_build(&studio, scene);
    set.settings.camera = made_camera(dvec3(0, 0.8, 2.5), dvec3(0, 0, 0), 1.2);
    set.settings.lights[0] = made_light(LIGHT_DIRECTIONAL, dvec3(0, 1, 0), dvec3(0, 0, 0));
    set.settings.light_count = 1;
    return set;
}

static void check_holes(const struct shadow_system *system, struct set *set, bool holes)
{
    float *truth;
    uint8_t *receiver;
    set->settings.system = system;
    set->settings.params = shadow_defaults(system);
    struct shot shot = shot_take(&studio, set);
    shot_truth(&studio, set, &shot, 0, &truth, &receiver);
    size_t inside = 0, dark = 0, wrong = 0;
    for (size_t i = 0; i < (size_t)shot.width * shot.height; i++) {
        bool under = receiver[i] && shot.ids[i] < 2;
        inside += under;
        dark += under && truth[i] < 0.5;
        wrong += under && fabsf(truth[i] - shot.visibility[0][i]) > 0.5f;
    }
    if (!(system->flags & SHADOW_NO_SHADOWS) && wrong > inside / 50)
        fail_msg("%s: %zu of %zu floor pixels are wrong under a roof with%s holes", system->name, wrong, inside,
                 holes ? "" : "out");
    assert_true(dark > 200 && inside > dark + 200);
    free(receiver);
    free(truth);
    shot_drop(&shot);
}

static void test_masked_casters_have_holes(void **state)
{
    (void)state;
    for (int holes = 0; holes < 2; holes++) {
        struct set set = make_masked(holes);
        for (size_t i = 0; i < shadow_system_count; i++)
            check_holes(shadow_systems[i], &set, holes);
        set_strike(&set);
    }
}

/* A light of a kind that a system does not take is refused with a sentence, and the renderer goes on. */
static void test_other_light_kinds_are_refused(void **state)
{
    (void)state;
    struct set set = make_stage(SOME);
    for (size_t i = 0; i < shadow_system_count; i++)
        for (size_t k = 0; k < 3; k++) {
            struct error err = {0};
            struct shadow_system blind = *shadow_systems[i];
            blind.lights &= ~(1u << kinds[k]);
            set.settings.lights[0] = light_of(kinds[k]);
            set.settings.system = &blind;
            assert_false(renderer_submit(studio.renderer, set.uploaded, &set.settings, 0, &err));
            assert_int_equal(err.code, ERROR_USAGE);
            assert_non_null(strstr(err.message, blind.name));
        }
    set.settings.system = shadow_systems[0];
    set.settings.params = shadow_defaults(shadow_systems[0]);
    struct shot shot = shot_take(&studio, &set);
    shot_drop(&shot);
    set_strike(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_answers_repeat),
        cmocka_unit_test(test_without_casters_all_is_lit),
        cmocka_unit_test(test_under_full_cover_all_is_dark),
        cmocka_unit_test(test_exact_systems_equal_the_reference),
        cmocka_unit_test(test_errors_shrink_with_size),
        cmocka_unit_test(test_lights_do_not_mix),
        cmocka_unit_test(test_masked_casters_have_holes),
        cmocka_unit_test(test_other_light_kinds_are_refused),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
