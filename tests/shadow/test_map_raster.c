/* Depth maps rasterized on the CPU: against rays in double, and without cracks; every instruction set gives the same bits. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "made_scene.h"
#include "scene/view.h"
#include "shadow/depth/depth_pass.h"
#include "shadow/depth/map_raster.h"

enum { SIDE = 101, TEXELS = SIDE * SIDE };

static struct job_pool *pool;

static struct view looking_down(bool orthographic)
{
    struct view v = {.width = SIDE,
                     .height = SIDE,
                     .orthographic = orthographic,
                     .eye = dvec3(0, 4, 0),
                     .right = dvec3(1, 0, 0),
                     .up = dvec3(0, 0, -1),
                     .forward = dvec3(0, -1, 0),
                     .near = orthographic ? 0.5 : 2,
                     .far = orthographic ? 9 : INFINITY};
    double edge = orthographic ? 3 : 0.8;
    v.left = v.bottom = -edge;
    v.right_edge = v.top = edge;
    return v;
}

static bool draw(const struct scene *scene, const struct view *view, const struct depth_kernel *kernel, float *texels)
{
    struct error err = {0};
    struct map_raster raster = {0};
    const uint32_t casters[2] = {0, 1};
    bool done;
    for (int again = 0; again < 2; again++)
        if (!map_raster_draw(&raster, scene, view, casters, scene->instance_count, kernel, pool, texels, &done, &err))
            fail_msg("%s", err.message);
    assert_true(!done || map_raster_bytes(&raster) > 0);
    map_raster_finish(&raster);
    return done;
}

static float noise(uint32_t *seed)
{
    *seed = *seed * 1664525 + 1013904223;
    return (float)(*seed >> 8) / (1 << 24) * 2 - 1;
}

/* Triangles of all sizes. */
static struct scene *make_soup(int count, float size, uint32_t seed)
{
    struct scene *scene = made_scene();
    float(*points)[3] = calloc((size_t)count * 3, sizeof *points);
    assert_non_null(points);
    for (int i = 0; i < count; i++) {
        float at[3] = {1.5f * noise(&seed), noise(&seed), 1.5f * noise(&seed)}, r = size * fabsf(noise(&seed));
        for (int k = 0; k < 3; k++)
            for (int c = 0; c < 3; c++)
                points[3 * i + k][c] = at[c] + r * noise(&seed);
    }
    made_triangles(scene, (const float(*)[3])points, (uint32_t)count * 3, made_material(scene, true));
    made_finish(scene);
    free(points);
    return scene;
}

/* The nearest depth along the view's axis through a texel's centre, moved by (dx, dy) texels; INFINITY: none. */
static double ray_depth(const struct scene *scene, const struct view *view, int x, int y, double dx, double dy)
{
    struct dvec3 o, d;
    double best = INFINITY;
    view_ray(view, x + 0.5 + dx, y + 0.5 + dy, &o, &d);
    for (uint32_t t = 0; t < scene->drawn_triangle_count; t++) {
        struct dvec3 a = instance_vertex(scene, &scene->instances[0], t, 0),
                     b = instance_vertex(scene, &scene->instances[0], t, 1),
                     c = instance_vertex(scene, &scene->instances[0], t, 2);
        struct dvec3 u = dvec3_sub(b, a), v = dvec3_sub(c, a), n = dvec3_cross(u, v), s = dvec3_sub(o, a);
        double det = -dvec3_dot(d, n), depth = dvec3_dot(s, n) / det;
        struct dvec3 m = dvec3_cross(s, d);
        double p = dvec3_dot(v, m) / det, q = -dvec3_dot(u, m) / det;
        if (p >= 0 && q >= 0 && p + q <= 1 && depth < best)
            best = depth;
    }
    return best;
}

static float stored(const struct view *v, double depth)
{
    double t = isinf(depth) ? 0 : v->orthographic ? (v->far - depth) / (v->far - v->near) : v->near / depth;
    return (float)fmin(fmax(t, 0), 1);
}

/* A texel is right if it holds what a ray near its centre finds: within 1/100 of a texel. */
static int count_wrong(const struct scene *scene, const struct view *view, const float *texels)
{
    int wrong = 0;
    for (int i = 0; i < TEXELS; i++) {
        bool right = false;
        for (int k = 0; k < 9 && !right; k++) {
            double depth = ray_depth(scene, view, i % SIDE, i / SIDE, 0.01 * (k % 3 - 1), 0.01 * (k / 3 - 1));
            right = fabsf(stored(view, depth) - texels[i]) < 2e-4f;
        }
        wrong += !right;
    }
    return wrong;
}

static void test_rays_find_the_same(void **state)
{
    (void)state;
    static const struct {
        int count;
        float size;
    } soups[] = {{12, 2.0f}, {500, 0.15f}};
    for (int k = 0; k < 4; k++) {
        struct scene *scene = make_soup(soups[k / 2].count, soups[k / 2].size, (uint32_t)k);
        struct view view = looking_down(k % 2);
        float texels[TEXELS];
        assert_true(draw(scene, &view, depth_kernel_choose(), texels));
        int covered = 0;
        for (int i = 0; i < TEXELS; i++)
            covered += texels[i] > 0;
        assert_in_range(covered, 100, TEXELS - 100);
        /* An edge that grazes a centre may be seen by none of the nine rays. */
        assert_in_range(count_wrong(scene, &view, texels), 0, 3);
        /* And the comparison finds fault with a map that is off by half a texel. */
        view.left += (view.right_edge - view.left) / SIDE / 2;
        assert_true(count_wrong(scene, &view, texels) > 30);
        scene_destroy(scene);
    }
}

/* A fan around points that lie on texel centres and beside them: no texel within it stays open. */
static void test_no_cracks(void **state)
{
    (void)state;
    for (int k = 0; k < 40; k++) {
        struct scene *scene = made_scene();
        struct view view = looking_down(true);
        enum { SPOKES = 23 };
        float points[SPOKES * 3][3], texel = 6.0f / SIDE, x = texel * (float)(k % 5), z = texel * 0.5f * (float)(k / 5);
        for (int i = 0; i < SPOKES; i++)
            for (int c = 0; c < 3; c++) {
                float a = 6.2831853f / SPOKES * (float)((i + (c == 2)) % SPOKES);
                points[3 * i + c][0] = c == 0 ? x : 2.5f * cosf(a);
                points[3 * i + c][1] = 0.1f * (float)i;
                points[3 * i + c][2] = c == 0 ? z : 2.5f * sinf(a);
            }
        made_triangles(scene, (const float(*)[3])points, SPOKES * 3, made_material(scene, true));
        made_finish(scene);
        float texels[TEXELS];
        assert_true(draw(scene, &view, depth_kernel_choose(), texels));
        for (int i = 0; i < TEXELS; i++)
            if (hypot(i % SIDE - SIDE / 2, i / SIDE - SIDE / 2) < 2.3 / (double)texel)
                assert_true(texels[i] > 0);
        scene_destroy(scene);
    }
}

static void test_same_bits(void **state)
{
    (void)state;
    if (!depth_avx2.rasterize || depth_kernel_choose() == &depth_plain)
        skip();
    for (int k = 0; k < 4; k++) {
        struct scene *scene = make_soup(400, k < 2 ? 0.6f : 0.03f, 7 + (uint32_t)k);
        struct view view = looking_down(k % 2);
        float plain[TEXELS], wide[TEXELS];
        assert_true(draw(scene, &view, &depth_plain, plain));
        assert_true(draw(scene, &view, &depth_avx2, wide));
        assert_memory_equal(plain, wide, sizeof plain);
        assert_true(draw(scene, &view, depth_kernel_choose(), wide));
        assert_memory_equal(plain, wide, sizeof plain);
        scene_destroy(scene);
    }
}

/* What it leaves to others: holes, and what reaches behind the light. */
static void test_refusals(void **state)
{
    (void)state;
    float texels[TEXELS];
    struct view view = looking_down(false);
    const float through[3][3] = {{0, 6, 0}, {1, 0, 0}, {0, 0, 1}};
    struct scene *scene = made_scene();
    made_triangles(scene, through, 3, made_material(scene, true));
    made_finish(scene);
    assert_false(draw(scene, &view, depth_kernel_choose(), texels));
    scene_destroy(scene);

    const float points[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, uv[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    const uint32_t indices[3] = {0, 1, 2};
    const uint8_t solid[4] = {1, 0, 0, 1};
    scene = made_scene();
    uint32_t masked = made_material(scene, true);
    made_mask(scene, masked, 2, solid);
    made_instance(scene, made_mesh(scene, points, uv, 3, indices, 3, masked), affine_identity());
    made_finish(scene);
    assert_false(draw(scene, &view, depth_kernel_choose(), texels));
    scene_destroy(scene);
}

int main(void)
{
    struct error err = {0};
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rays_find_the_same),
        cmocka_unit_test(test_no_cracks),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_refusals),
    };
    pool = job_pool_create(2, &err);
    if (!pool)
        return 1;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    job_pool_destroy(pool);
    return failed;
}
