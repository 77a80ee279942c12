/* Checks that need no reference: what must not change when a scene is told differently. Translation binds every system; the rest those that
 * promise the truth. Coordinates are multiples of 1/256, so that moved vertices and midpoints are exact in floats. */
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

enum { TRIANGLES = 60, WIDTH = 96, HEIGHT = 54 };

static struct studio studio;

/* How the same scene is told. */
struct telling {
    double offset;    /* of everything along x and -z */
    double scale;     /* a power of two; 0: 1 */
    bool reversed;    /* triangles in the opposite order */
    bool subdivided;  /* each triangle as four */
    bool extra;       /* one more caster, out of the picture */
    bool turned;      /* the direction of a point light, which means nothing */
    uint32_t samples; /* 0: the system's default */
    enum light_kind kind;
};

static double drawn(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 24) / 128 - 1; /* multiples of 1/128 in [-1, 1) */
}

struct soup {
    float points[12 * (TRIANGLES + 3)][3];
    uint32_t count;
};

static void put(struct soup *s, struct dvec3 p)
{
    float *to = s->points[s->count++];
    to[0] = (float)p.x;
    to[1] = (float)p.y;
    to[2] = (float)p.z;
}

static void put_triangle(struct soup *s, const struct dvec3 p[3], bool subdivided)
{
    struct dvec3 m[3];
    for (int k = 0; k < 3; k++)
        m[k] = dvec3_scale(dvec3_add(p[k], p[(k + 1) % 3]), 0.5);
    const struct dvec3 parts[4][3] = {{p[0], m[0], m[2]}, {m[0], p[1], m[1]}, {m[2], m[1], p[2]}, {m[0], m[1], m[2]}};
    for (int i = 0; i < (subdivided ? 4 : 1); i++)
        for (int k = 0; k < 3; k++)
            put(s, subdivided ? parts[i][k] : p[k]);
}

/* A floor, loose triangles over it, and perhaps one more. */
static void fill(struct soup *s, const struct telling *t)
{
    struct dvec3 all[TRIANGLES + 3][3] = {{{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}}, {{-4, 0, -4}, {4, 0, 4}, {4, 0, -4}}};
    uint32_t seed = 11, count = 2;
    for (; count < TRIANGLES + 2; count++) {
        struct dvec3 middle = {2 * drawn(&seed), 1.25 + drawn(&seed), 2 * drawn(&seed)};
        for (int k = 0; k < 3; k++)
            all[count][k] = dvec3_add(middle, dvec3_scale(dvec3(drawn(&seed), drawn(&seed), drawn(&seed)), 0.5));
    }
    if (t->extra) {
        const struct dvec3 sail[3] = {{2, 4.5, 0.25}, {2.75, 4.5, 1.75}, {1.25, 4.25, 1.5}};
        memcpy(all[count++], sail, sizeof sail);
    }
    for (uint32_t i = 0; i < count; i++)
        put_triangle(s, all[t->reversed ? count - 1 - i : i], t->subdivided);
}

static struct set build(const struct telling *t)
{
    struct soup *soup = calloc(1, sizeof *soup);
    assert_non_null(soup);
    fill(soup, t);
    struct scene *scene = made_scene();
    double scale = t->scale > 0 ? t->scale : 1;
    struct dvec3 offset = {t->offset, 0, -t->offset};
    uint32_t indices[12 * (TRIANGLES + 3)];
    for (uint32_t i = 0; i < soup->count; i++)
        indices[i] = i;
    uint32_t mesh =
        made_mesh(scene, (const float(*)[3])soup->points, NULL, soup->count, indices, soup->count, made_material(scene, true));
    made_instance(scene, mesh, (struct affine){{{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}}, {offset.x, offset.y, offset.z}});
    free(soup);
    scene->lights = calloc(1, sizeof *scene->lights);
    scene->cameras = calloc(1, sizeof *scene->cameras);
    assert_true(scene->lights && scene->cameras);
    scene->light_count = scene->camera_count = 1;
    struct light *light = &scene->lights[0];
    *light = made_light(t->kind, dvec3_add(dvec3_scale(dvec3(2.5, 5, 1.25), scale), offset), offset);
    light->direction = dvec3_normalize(dvec3(-2, -4, -1));
    light->outer = 0.6;
    if (t->turned)
        light->direction = dvec3(0, 0, 1);
    scene->cameras[0] = made_camera(dvec3(0.25, 3.5, 6), dvec3(0, 0.5, 0), 0.8);
    scene->cameras[0].eye = dvec3_add(dvec3_scale(scene->cameras[0].eye, scale), offset);
    scene->cameras[0].near *= scale;
    scene->cameras[0].far *= scale;
    made_finish(scene);
    struct set set = set_build(&studio, scene);
    set.settings.width = WIDTH;
    set.settings.height = HEIGHT;
    return set;
}

static struct shot take(const struct telling *t, const struct shadow_system *system)
{
    struct set set = build(t);
    struct error err = {0};
    set.settings.system = system;
    set.settings.params = shadow_defaults(system);
    if (t->samples)
        assert_true(shadow_param_parse(system, &set.settings.params, "samples", t->samples == 32 ? "32" : "1", &err));
    struct shot shot = shot_take(&studio, &set);
    set_strike(&set);
    return shot;
}

/* Pixels whose visibility differs; `lighter`: only those that the second made lighter. */
static size_t differing(const struct shot *a, const struct shot *b, bool lighter)
{
    size_t count = 0;
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        count += lighter ? b->visibility[0][i] > a->visibility[0][i] : b->visibility[0][i] != a->visibility[0][i];
    return count;
}

static size_t compare(const struct telling *plain, const struct telling *told, const struct shadow_system *system)
{
    struct shot a = take(plain, system), b = take(told, system);
    size_t count = differing(&a, &b, told->extra);
    if (!told->extra && !told->reversed && !told->subdivided && !told->scale && !shot_same(&a, &b))
        count = count ? count : 1;
    shot_drop(&b);
    shot_drop(&a);
    return count;
}

/* Every kind of light; of the systems that promise the truth also 32 samples. */
static void check(const char *what, struct telling told, bool exact_only)
{
    for (size_t i = 0; i < shadow_system_count; i++) {
        const struct shadow_system *system = shadow_systems[i];
        bool exact = system->flags & SHADOW_EXACT, masks = shadow_param_index(system, "samples") >= 0 && exact;
        if (exact_only && !exact)
            continue;
        for (told.kind = LIGHT_DIRECTIONAL; told.kind <= LIGHT_SPOT; told.kind++)
            for (told.samples = masks ? 1 : 0; told.samples <= (masks ? 32 : 0); told.samples += 31) {
                const struct telling plain = {.kind = told.kind, .samples = told.samples};
                size_t count = compare(&plain, &told, system);
                if (count)
                    fail_msg("%s, light kind %d, samples %u: %s changes %zu pixels", system->name, (int)told.kind, told.samples,
                             what, count);
                if (!masks)
                    break;
            }
    }
}

static void test_moving_the_world_changes_nothing(void **state)
{
    (void)state;
    check("an offset of 1e3", (struct telling){.offset = 1000}, false);
    check("an offset of 1e7", (struct telling){.offset = 1e7}, false);
}

static void test_a_point_light_has_no_direction(void **state)
{
    (void)state;
    for (size_t i = 0; i < shadow_system_count; i++) {
        const struct telling plain = {.kind = LIGHT_POINT}, turned = {.kind = LIGHT_POINT, .turned = true};
        assert_int_equal(compare(&plain, &turned, shadow_systems[i]), 0);
    }
}

static void test_scale_changes_no_visibility(void **state)
{
    (void)state;
    check("a scale of 8192", (struct telling){.scale = 8192}, true);
    check("a scale of 1/8192", (struct telling){.scale = 1.0 / 8192}, true);
}

static void test_order_changes_no_visibility(void **state)
{
    (void)state;
    check("the order of triangles", (struct telling){.reversed = true}, true);
}

static void test_subdivision_changes_no_visibility(void **state)
{
    (void)state;
    check("subdivision", (struct telling){.subdivided = true}, true);
}

static void test_a_caster_never_lightens(void **state)
{
    (void)state;
    check("one more caster", (struct telling){.extra = true}, true);
}

/* The comparison sees what differs: one more caster darkens. */
static void test_the_comparison_can_fail(void **state)
{
    (void)state;
    const struct telling plain = {.kind = LIGHT_POINT}, told = {.kind = LIGHT_POINT, .extra = true};
    const struct shadow_system *system = shadow_default();
    struct shot a = take(&plain, system), b = take(&told, system);
    assert_true(differing(&a, &b, false) > 20);
    assert_true(differing(&b, &a, true) > 20);
    shot_drop(&b);
    shot_drop(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moving_the_world_changes_nothing),  cmocka_unit_test(test_a_point_light_has_no_direction),
        cmocka_unit_test(test_scale_changes_no_visibility),       cmocka_unit_test(test_order_changes_no_visibility),
        cmocka_unit_test(test_subdivision_changes_no_visibility), cmocka_unit_test(test_a_caster_never_lightens),
        cmocka_unit_test(test_the_comparison_can_fail),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
