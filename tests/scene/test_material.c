/* material_alpha(): wrap modes, transform, nearest texel, hostile coordinates. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "made_scene.h"

static const uint8_t checks[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static struct scene *masked(enum wrap_mode wrap)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true);
    made_mask(scene, material, 4, checks);
    scene->textures[0].wrap_s = scene->textures[0].wrap_t = wrap;
    return scene;
}

/* The texel column that `u` lands in, by the diagonal of checks[]. */
static int column(const struct scene *scene, float u)
{
    for (int row = 0; row < 4; row++) {
        const float uv[2] = {u, ((float)row + 0.5f) / 4};
        if (material_alpha(scene, &scene->materials[0], uv, 1) > 0.5f)
            return row;
    }
    return -1;
}

static void wraps(void **state)
{
    (void)state;
    const float u[] = {0.1f, 0.3f, 0.99f, 1.1f, 1.3f, 2.05f, -0.1f, -0.3f, -1.1f};
    const int repeat[] = {0, 1, 3, 0, 1, 0, 3, 2, 3}, mirror[] = {0, 1, 3, 3, 2, 0, 0, 1, 3},
              clamp[] = {0, 1, 3, 3, 3, 3, 0, 0, 0};
    const int *const wanted[] = {repeat, mirror, clamp};
    for (int mode = 0; mode < 3; mode++) {
        struct scene *scene = masked((enum wrap_mode)mode);
        for (size_t i = 0; i < sizeof u / sizeof *u; i++)
            assert_int_equal(column(scene, u[i]), wanted[mode][i]);
        scene_destroy(scene);
    }
}

static void survives_any_coordinate(void **state)
{
    (void)state;
    const float odd[] = {NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 2147483648.0f, 1.0f, -0.0f, 1e-45f};
    for (int mode = 0; mode < 3; mode++) {
        struct scene *scene = masked((enum wrap_mode)mode);
        for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
            const float uv[2] = {odd[i], odd[(i + 1) % 9]};
            float alpha = material_alpha(scene, &scene->materials[0], uv, 1);
            assert_true(alpha == 0 || alpha == 1);
        }
        scene_destroy(scene);
    }
}

static void factors_multiply(void **state)
{
    (void)state;
    struct scene *scene = masked(WRAP_REPEAT);
    struct material *m = &scene->materials[0];
    const float solid[2] = {0.1f, 0.1f}, hole[2] = {0.3f, 0.1f};
    m->base_color[3] = 0.5f;
    assert_true(material_alpha(scene, m, solid, 0.5f) == 0.25f);
    assert_true(material_alpha(scene, m, hole, 0.5f) == 0);
    m->base_color_texture.texture = SCENE_NONE;
    assert_true(material_alpha(scene, m, hole, 0.5f) == 0.25f);
    scene_destroy(scene);
}

static void transforms_before_it_looks(void **state)
{
    (void)state;
    struct scene *scene = masked(WRAP_REPEAT);
    struct material *m = &scene->materials[0];
    const float moved[2][3] = {{0, 1, 0.25f}, {1, 0, 0.5f}}, uv[2] = {0.1f, 0.35f};
    for (int i = 0; i < 6; i++)
        m->base_color_texture.transform[i / 3][i % 3] = moved[i / 3][i % 3];
    /* (0.35 + 0.25, 0.1 + 0.5): texel (2, 2). */
    assert_true(material_alpha(scene, m, uv, 1) == 1);
    scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wraps),
        cmocka_unit_test(survives_any_coordinate),
        cmocka_unit_test(factors_multiply),
        cmocka_unit_test(transforms_before_it_looks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
