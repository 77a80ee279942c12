/* Exact shadows against the reference, bit by bit; and against the second opinion, which shares no code with either. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "exact/exact_shadows.h"
#include "hard_scenes.h"
#include "rational.h"
#include "reference/reference.h"
#include "trace/tracer.h"

enum { WIDTH = 44, HEIGHT = 28, PIXELS = WIDTH * HEIGHT };

struct wrong {
    uint64_t points, samples, rational; /* that differ */
    uint64_t receivers, shadowed;       /* samples there were */
    double undecided, exact;
};

/* One scene, both ways. `shown` is what exact shadows are made of: `scene`, unless a test wants to see a difference. */
struct pair {
    const struct scene *scene, *shown;
    struct reference *reference;
    struct tracer *tracer;
    struct exact_shadows *exact;
    struct job_pool *pool;
    struct view view;
    struct light light;
    struct wrong wrong;
};

static void pair_begin(struct pair *p, const struct scene *scene, const struct scene *shown, size_t memory)
{
    struct error err = {0};
    *p = (struct pair){.scene = scene, .shown = shown};
    p->pool = job_pool_create(2, &err);
    p->reference = reference_create(scene, 1, &err);
    p->tracer = tracer_create(scene, 1, &err);
    p->exact = exact_shadows_create(shown, memory, &err);
    assert_non_null(p->exact);
}

static void pair_end(struct pair *p)
{
    exact_shadows_destroy(p->exact);
    tracer_destroy(p->tracer);
    reference_destroy(p->reference);
    job_pool_destroy(p->pool);
}

static void compare_points(struct pair *p)
{
    static uint32_t ids[PIXELS];
    static float truth[PIXELS];
    struct error err = {0};
    tracer_camera(p->tracer, &p->view, p->pool, ids, NULL);
    assert_true(reference_point(p->reference, &p->view, &p->light, ids, p->pool, NULL, truth, NULL, NULL));
    const float *tested = exact_shadows_point(p->exact, &p->view, ids, p->pool, &err);
    assert_non_null(tested);
    for (size_t i = 0; i < PIXELS; i++)
        p->wrong.points += tested[i] != truth[i];
    p->wrong.exact += exact_shadows_figures(p->exact).exact;
}

static void compare_samples(struct pair *p)
{
    static uint32_t receivers[PIXELS], lit[PIXELS];
    const uint32_t *own_receivers, *own_lit;
    struct error err = {0};
    assert_true(reference_samples32(p->reference, &p->view, &p->light, p->pool, NULL, receivers, lit, NULL, NULL));
    const float *tested = exact_shadows_samples32(p->exact, &p->view, p->pool, &own_receivers, &own_lit, &err);
    assert_non_null(tested);
    for (size_t i = 0; i < PIXELS; i++) {
        int all = __builtin_popcount(receivers[i]), free = __builtin_popcount(lit[i]);
        p->wrong.samples += (unsigned)__builtin_popcount((receivers[i] ^ own_receivers[i]) | (lit[i] ^ own_lit[i]));
        p->wrong.receivers += (unsigned)all;
        p->wrong.shadowed += (unsigned)(all - free);
        if (receivers[i] == own_receivers[i] && lit[i] == own_lit[i])
            assert_float_equal(tested[i], all ? (float)free / (float)all : 0, 0);
    }
    struct exact_figures f = exact_shadows_figures(p->exact);
    p->wrong.undecided += f.undecided_fraction;
    p->wrong.exact += f.exact;
}

/* A few samples against rational arithmetic. */
static void compare_rational(struct pair *p)
{
    const uint32_t *receivers, *lit;
    struct error err = {0};
    struct rational *rational = rational_create(p->scene);
    exact_shadows_samples32(p->exact, &p->view, p->pool, &receivers, &lit, &err);
    for (uint32_t k = 0; k < 40; k++) {
        uint32_t x = k * 7 % WIDTH, y = k * 5 % HEIGHT, i = k * 11 % 32;
        double px = x + (double)view_samples32[i][0], py = y + (double)view_samples32[i][1];
        enum rational_answer answer =
            rational_light(rational, &p->view, &p->light, rational_visible(rational, &p->view, px, py), px, py);
        p->wrong.rational += (receivers[y * WIDTH + x] >> i & 1) != (answer != RATIONAL_NO_RECEIVER) ||
                             (lit[y * WIDTH + x] >> i & 1) != (answer == RATIONAL_LIT);
    }
    rational_destroy(rational);
}

static struct view view_of(const struct hard_scene *hard, bool orthographic, bool samples)
{
    struct camera camera = made_camera(hard->eye, hard->target, 0.7);
    camera.orthographic = orthographic || hard->grid;
    camera.ymag = 1.4;
    camera.far = 5.5;
    if (hard->grid) {
        /* So that samples, or centres, fall on the scene's integers. */
        camera.ymag = HEIGHT / (samples ? 2.0 : 16.0);
        camera.far = 20;
        camera.eye.x += samples ? 1.0 / 64 : 1.0 / 16;
        camera.eye.y += samples ? -1.0 / 64 : -1.0 / 16;
    }
    return view_from_camera(&camera, WIDTH, HEIGHT);
}

static struct light light_of(const struct hard_scene *hard, enum light_kind kind)
{
    struct light light = made_light(kind, hard->light, hard->target);
    light.outer = 0.5;
    light.range = kind == LIGHT_SPOT ? 5.25 : 0;
    return light;
}

static void set_light(struct pair *p, struct light light)
{
    struct error err = {0};
    p->light = light;
    assert_true(exact_shadows_set_light(p->exact, &p->light, p->pool, &err));
}

static void check_all_lights(struct pair *p, const struct hard_scene *hard, bool rational)
{
    for (int kind = LIGHT_DIRECTIONAL; kind <= LIGHT_SPOT; kind++) {
        set_light(p, light_of(hard, (enum light_kind)kind));
        for (int flat = 0; flat < 2; flat++) {
            /* The plain code on every second picture. */
            exact_shadows_use_plain(p->exact, (kind + flat) % 2);
            p->view = view_of(hard, flat, false);
            compare_points(p);
            p->view = view_of(hard, flat, true);
            compare_samples(p);
            if (rational)
                compare_rational(p);
        }
    }
}

static void assert_equal(const struct pair *p, const char *name)
{
    const struct wrong *w = &p->wrong;
    if (w->points || w->samples || w->rational)
        print_message("%s: %zu points, %zu of %zu samples, %zu of the rational ones wrong\n", name, (size_t)w->points,
                      (size_t)w->samples, (size_t)w->receivers, (size_t)w->rational);
    assert_int_equal(w->points, 0);
    assert_int_equal(w->samples, 0);
    assert_int_equal(w->rational, 0);
}

static void hard_scenes_equal(void **state)
{
    (void)state;
    double exact = 0;
    for (size_t i = 0; i < hard_scene_count; i++) {
        struct scene *scene = hard_scenes[i].make();
        struct pair p;
        pair_begin(&p, scene, scene, 0);
        check_all_lights(&p, &hard_scenes[i], true);
        assert_equal(&p, hard_scenes[i].name);
        exact += p.wrong.exact;
        pair_end(&p);
        scene_destroy(scene);
    }
    assert_true(exact > 1000); /* they do reach exact arithmetic */
}

static uint32_t random_bits(uint32_t *seed)
{
    *seed ^= *seed << 13;
    *seed ^= *seed >> 17;
    return *seed ^= *seed << 5;
}

static float random_coordinate(uint32_t *seed) { return (float)(random_bits(seed) >> 8) / 8388608.0f - 1; }

/* `count` triangles around the origin, of which every third is a sliver, times `scale`; the light may be among them. */
static struct scene *soup(uint32_t seed, unsigned count, float scale)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, seed % 2);
    float(*p)[3] = malloc(3 * count * sizeof *p);
    for (unsigned t = 0; t < count; t++) {
        float size = t % 7 == 0 ? 1.5f : 0.2f, thin = t % 3 == 0 ? 1e-5f : 1;
        for (int i = 0; i < 3; i++) {
            float center = random_coordinate(&seed), along = random_coordinate(&seed) * size;
            p[3 * t][i] = center * scale;
            p[3 * t + 1][i] = (center + along) * scale;
            p[3 * t + 2][i] = (center + (thin < 1 ? along * 0.5f : 0) + random_coordinate(&seed) * size * thin) * scale;
        }
    }
    made_triangles(scene, (const float(*)[3])p, 3 * count, material);
    free(p);
    made_finish(scene);
    return scene;
}

static struct hard_scene soup_view(uint32_t seed, double scale)
{
    /* Every third light is far out, so that its faces are one; the camera of every fourth is inside. */
    double away = seed % 3 == 0 ? 6 : 0.4, eye = seed % 4 == 0 ? 0.3 : 2.8;
    return (struct hard_scene){.name = "soup",
                               .eye = dvec3(eye * scale, 0.7 * eye * scale, 0.5 * eye * scale),
                               .target = dvec3(0, 0, 0),
                               .light = dvec3(0.2 * away * scale, away * scale, -0.3 * away * scale)};
}

/* Three soups with masks, each wrapped another way, coordinates beyond the texture included. */
static struct scene *masked_soup(uint32_t seed, unsigned count, float scale)
{
    enum { SIDE = 37 };
    struct scene *scene = made_scene();
    uint8_t solid[SIDE * SIDE];
    float(*p)[3] = malloc(3 * count * sizeof *p), (*uv)[2] = malloc(3 * count * sizeof *uv);
    uint32_t *indices = malloc(3 * count * sizeof *indices);
    for (int wrap = WRAP_REPEAT; wrap <= WRAP_CLAMP_TO_EDGE; wrap++) {
        uint32_t material = made_material(scene, true);
        struct texture_use *use = &scene->materials[material].base_color_texture;
        for (int i = 0; i < SIDE * SIDE; i++)
            solid[i] = random_bits(&seed) % 3 != 0;
        made_mask(scene, material, SIDE, solid);
        use->transform[0][1] = 0.5f * (float)wrap, use->transform[1][2] = 0.3f;
        scene->textures[use->texture].wrap_s = (enum wrap_mode)wrap;
        scene->textures[use->texture].wrap_t = (enum wrap_mode)((wrap + 1) % 3);
        for (unsigned t = 0; t < count; t++) {
            float spread = t % 5 == 0 ? 1e-6f : t % 5 == 1 ? 40 : 0.7f, thin = t % 6 == 0 ? 1e-5f : 1;
            for (int i = 0; i < 3; i++) {
                float center = random_coordinate(&seed), along = 0.5f * random_coordinate(&seed);
                p[3 * t][i] = center * scale;
                p[3 * t + 1][i] = (center + along) * scale;
                p[3 * t + 2][i] = (center + (thin < 1 ? along * 0.5f : 0) + 0.5f * random_coordinate(&seed) * thin) * scale;
                for (int k = 0; k < 2; k++)
                    uv[3 * t + (unsigned)i][k] = spread * random_coordinate(&seed);
                indices[3 * t + (unsigned)i] = 3 * t + (unsigned)i;
            }
        }
        made_instance(scene,
                      made_mesh(scene, (const float(*)[3])p, (const float(*)[2])uv, 3 * count, indices, 3 * count, material),
                      affine_identity());
    }
    free(indices);
    free(uv);
    free(p);
    made_finish(scene);
    return scene;
}

/* Takes the scene. */
static void check_soup(struct scene *scene, uint32_t seed, float scale, size_t memory)
{
    struct hard_scene at = soup_view(seed, (double)scale);
    struct pair p;
    pair_begin(&p, scene, scene, memory);
    for (int kind = LIGHT_DIRECTIONAL; kind <= LIGHT_SPOT; kind++) {
        struct light light = light_of(&at, (enum light_kind)kind);
        struct camera camera = made_camera(at.eye, at.target, 0.9);
        light.range = kind == LIGHT_SPOT ? 3 * (double)scale : 0;
        light.outer = seed % 2 ? 0.6 : 1.3;
        camera.orthographic = (seed + (unsigned)kind) % 4 == 3;
        camera.ymag = (double)scale;
        camera.near = 1e-3 * (double)scale;
        camera.far = 20 * (double)scale;
        set_light(&p, light);
        p.view = view_from_camera(&camera, WIDTH, HEIGHT);
        exact_shadows_use_plain(p.exact, seed % 2);
        compare_points(&p);
        compare_samples(&p);
    }
    assert_equal(&p, "soup");
    assert_true(p.wrong.shadowed > 200);
    pair_end(&p);
    scene_destroy(scene);
}

static void soups_equal(void **state)
{
    (void)state;
    for (uint32_t seed = 1; seed <= 8; seed++)
        check_soup(soup(seed, 60 + 40 * seed, 1), seed, 1, 0);
}

static void masks_equal(void **state)
{
    (void)state;
    for (uint32_t seed = 1; seed <= 6; seed++)
        check_soup(masked_soup(seed, 40, 1), seed, 1, 0);
    check_soup(masked_soup(7, 40, 1e3f), 7, 1e3f, 0);
}

static void scales_equal(void **state)
{
    (void)state;
    check_soup(soup(9, 90, 1e-4f), 9, 1e-4f, 0);
    check_soup(soup(10, 90, 1e4f), 10, 1e4f, 0);
    check_soup(soup(11, 90, 1e-9f), 11, 1e-9f, 0);
}

/* Just enough memory: the grid's cells are large, the answer the same. Less: one clear sentence. */
static void memory_changes_nothing(void **state)
{
    (void)state;
    enum { COUNT = 60000 };
    struct error err = {0};
    struct scene *scene = soup(12, COUNT, 1);
    struct light light = light_of(&(struct hard_scene){.light = {0.2, 6, 0.4}}, LIGHT_POINT);
    struct camera camera = made_camera(dvec3(2, 2, 2), dvec3(0, 0, 0), 0.7);
    struct view view = view_from_camera(&camera, WIDTH, HEIGHT);
    struct job_pool *pool = job_pool_create(1, &err);
    const uint32_t *receivers, *lit;
    uint32_t *kept = malloc(PIXELS * sizeof *kept);
    double sides[2];
    for (int tight = 0; tight < 2; tight++) {
        struct exact_shadows *e = exact_shadows_create(scene, tight ? (size_t)COUNT * 170 + 6000 : 0, &err);
        assert_true(exact_shadows_set_light(e, &light, pool, &err));
        assert_non_null(exact_shadows_samples32(e, &view, pool, &receivers, &lit, &err));
        sides[tight] = exact_shadows_figures(e).grid_side;
        if (tight)
            assert_memory_equal(lit, kept, PIXELS * sizeof *kept);
        memcpy(kept, lit, PIXELS * sizeof *kept);
        exact_shadows_destroy(e);
    }
    assert_true(sides[1] < sides[0]);
    struct exact_shadows *e = exact_shadows_create(scene, 4096, &err);
    assert_false(exact_shadows_set_light(e, &light, pool, &err));
    assert_non_null(strstr(err.message, "MiB"));
    exact_shadows_destroy(e);
    free(kept);
    job_pool_destroy(pool);
    scene_destroy(scene);
}

/* The same picture with one triangle elsewhere: the comparison must see it. */
static void a_moved_triangle_is_found(void **state)
{
    (void)state;
    const struct hard_scene *hard = &hard_scenes[0];
    struct scene *scene = hard->make(), *moved = hard->make();
    struct pair p;
    for (int i = 0; i < 3; i++)
        moved->positions[i][0] += 0.05f;
    pair_begin(&p, scene, moved, 0);
    check_all_lights(&p, hard, false);
    assert_true(p.wrong.samples > 0);
    assert_true(p.wrong.points > 0);
    pair_end(&p);
    scene_destroy(moved);
    scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hard_scenes_equal),
        cmocka_unit_test(soups_equal),
        cmocka_unit_test(masks_equal),
        cmocka_unit_test(scales_equal),
        cmocka_unit_test(memory_changes_nothing),
        cmocka_unit_test(a_moved_triangle_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
