/* Adaptive shadow maps: the budget, what a view's change does, and the tree. What every system keeps is in test_registry.c. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "blocks.h"
#include "frame.h"
#include "shadow/asm/tree.h"
#include "studio.h"

#define WIDTH  320
#define HEIGHT 180

static struct studio studio;

static struct set load_room(const char *camera, const char *algorithm)
{
    struct set set = set_load(&studio, "builtin:room");
    set.settings.width = WIDTH;
    set.settings.height = HEIGHT;
    set.settings.map_pass = CAMERA_PASS_TRACED;
    set_use(&set, algorithm);
    for (size_t i = 0; i < set.scene->camera_count; i++)
        if (strcmp(set.scene->cameras[i].name, camera) == 0) {
            set.settings.camera = set.scene->cameras[i];
            return set;
        }
    fail_msg("builtin:room has no camera '%s'", camera);
    return set;
}

/* One frame, converged or not; its visibility. */
static struct frame_info take_frame(struct set *set, float *visibility)
{
    static uint8_t pixels[WIDTH * HEIGHT * 4];
    struct error err = {0};
    struct frame_info info;
    if (!renderer_submit(studio.renderer, set->uploaded, &set->settings, 0, &err) ||
        !renderer_collect(studio.renderer, true, pixels, sizeof pixels, &info, &err))
        fail_msg("%s", err.message);
    assert_true(renderer_read_visibility(studio.renderer, 0, visibility));
    return info;
}

static int differing(const float *a, const float *b)
{
    int count = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        count += a[i] != b[i];
    return count;
}

static double figure(const struct frame_info *info, const char *name)
{
    for (size_t i = 0; i < info->figure_count; i++)
        if (strcmp(info->figures[i].name, name) == 0)
            return info->figures[i].value;
    fail_msg("there is no figure '%s'", name);
    return 0;
}

/* However many cameras, lights and frames; rasterized, traced; by shaders, on the CPU. */
static void test_never_over_budget(void **state)
{
    (void)state;
    static const int budgets[] = {1, 2, 5};
    static float visibility[WIDTH * HEIGHT];
    for (size_t b = 0; b < 3; b++) {
        char name[40];
        snprintf(name, sizeof name, "asm:budget=%d,analyse=2", budgets[b]);
        struct set set = load_room("close", name);
        double evictions = 0;
        for (int frame = 0; frame < 48; frame++) {
            set.settings.camera = set.scene->cameras[frame / 12 % set.scene->camera_count];
            set.settings.map_pass = frame == 40 ? CAMERA_PASS_RASTER : CAMERA_PASS_TRACED;
            set.settings.resolve_pass = frame < 30 || frame > 44 ? RESOLVE_PASS_CPU : RESOLVE_PASS_GPU;
            set.settings.lights[0].position.x = frame < 36 ? 0 : 0.01 * frame;
            struct frame_info info = take_frame(&set, visibility);
            assert_true(info.shadow_bytes > 0 && info.shadow_bytes <= (size_t)budgets[b] << 20);
            assert_true(figure(&info, "bytes") == (double)info.shadow_bytes);
            evictions += figure(&info, "evictions");
        }
        if (budgets[b] == 1)
            assert_true(evictions > 0);
        set_strike(&set);
    }
}

/* After a jump of the camera: within a tenth of the final error after 30 frames; far better than at first. */
static void test_converges_after_a_jump(void **state)
{
    (void)state;
    static float first[WIDTH * HEIGHT], later[WIDTH * HEIGHT], last[WIDTH * HEIGHT];
    struct set set = load_room("wide", "asm");
    struct shot wide = shot_take(&studio, &set);
    shot_drop(&wide);
    set.settings.camera = set.scene->cameras[1];
    for (int frame = 1; frame <= 30; frame++) {
        struct frame_info info = take_frame(&set, frame == 1 ? first : later);
        assert_true(frame > 1 || !info.converged);
    }
    struct shot done = shot_take(&studio, &set);
    memcpy(last, done.visibility[0], sizeof last);
    assert_true(figure(&done.info, "effective_resolution") >= 8192);
    assert_true(figure(&done.info, "nodes") > 100);
    float *truth;
    uint8_t *receiver;
    shot_truth(&studio, &set, &done, 0, &truth, &receiver);
    int at_first = 0, after = 0, at_last = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        if (receiver[i]) {
            at_first += first[i] != truth[i];
            after += later[i] != truth[i];
            at_last += last[i] != truth[i];
        }
    if (!(after <= 1.1 * at_last + 1 && 20 * at_last < at_first))
        fail_msg("%d pixels are wrong at first, %d after 30 frames, %d at last", at_first, after, at_last);
    struct frame_info still = take_frame(&set, later);
    assert_true(still.converged && !still.prepared);
    assert_int_equal(differing(later, last), 0);
    free(receiver);
    free(truth);
    shot_drop(&done);
    set_strike(&set);
}

/* What changes no map throws no page away; what moves the light does not start from nothing. */
static void test_lights_invalidate_what_they_must(void **state)
{
    (void)state;
    static float visibility[WIDTH * HEIGHT];
    struct set set = load_room("close", "asm");
    struct shot shot = shot_take(&studio, &set);
    double pages = figure(&shot.info, "nodes");
    shot_drop(&shot);
    set.settings.lights[0].intensity *= 2;
    set.settings.lights[0].range = 1000;
    struct frame_info info = take_frame(&set, visibility);
    assert_true(info.converged && figure(&info, "nodes") == pages);
    set.settings.lights[0].position.x += 1e-4;
    info = take_frame(&set, visibility);
    assert_false(info.converged);
    info = take_frame(&set, visibility);
    info = take_frame(&set, visibility);
    assert_true(figure(&info, "nodes") > 20);
    set_strike(&set);
}

static uint32_t count_pages(const struct asm_tree *t)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < t->slots; i++)
        count += asm_node_is_page(&t->nodes[i]);
    return count;
}

static struct view square_view(void)
{
    return (struct view){.width = 512, .height = 512, .left = -1, .right_edge = 1, .bottom = -1, .top = 1, .near = 1, .far = 9};
}

static void test_tree(void **state)
{
    (void)state;
    struct error err = {0};
    struct asm_tree t;
    const struct view maps[1] = {square_view()};
    assert_true(asm_tree_init(&t, &studio.renderer->gl, 4 * ASM_COLUMNS, &err));
    asm_tree_plant(&t, maps, 1);
    assert_int_equal(t.root_side, 64);
    uint32_t taken = t.free_count;
    /* Cell 1, 2 of the root's second page in its first row; cell 3, 0 of that. */
    uint32_t child = asm_tree_add(&t, 1, 1 + 2 * 4), deep = asm_tree_add(&t, child, 3);
    assert_int_equal(count_pages(&t), 2);
    assert_int_equal(t.free_count, taken - 2);
    assert_int_equal(t.nodes[deep].level, 2);
    struct view v = asm_tree_view(&t, child);
    assert_true(fabs(v.left - (-1 + 2 * 20.0 / 64)) < 1e-12 && fabs(v.right_edge - (-1 + 2 * 24.0 / 64)) < 1e-12);
    assert_true(fabs(v.top - (1 - 2 * 8.0 / 64)) < 1e-12);
    v = asm_tree_view(&t, deep);
    assert_true(fabs(v.left - (-1 + 2 * 23.0 / 64)) < 1e-12 && fabs(v.right_edge - (-1 + 2 * 24.0 / 64)) < 1e-12);
    /* A mesh elsewhere changes nothing; one beside the deep page, on the child, takes both. */
    assert_int_equal(asm_tree_invalidate(&t, 0, (const double[4]){0.5, 0.5, 0.6, 0.6}), 0);
    assert_int_equal(asm_tree_invalidate(&t, 0, (const double[4]){20.1 / 64, 8.1 / 64, 20.2 / 64, 8.2 / 64}), 2);
    assert_int_equal(count_pages(&t), 0);
    assert_int_equal(t.free_count, taken);
    for (uint32_t i = 0; i < taken; i++)
        if (asm_tree_add(&t, 0, i % 16) == ASM_FREE || i == 15)
            break;
    assert_int_equal(count_pages(&t), 16);
    asm_tree_prune(&t);
    assert_int_equal(count_pages(&t), 0);
    assert_int_equal(t.free_count, taken);
    asm_tree_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_never_over_budget),
        cmocka_unit_test(test_converges_after_a_jump),
        cmocka_unit_test(test_lights_invalidate_what_they_must),
        cmocka_unit_test(test_tree),
    };
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
