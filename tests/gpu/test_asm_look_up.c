/* Look-ups in a made-up tree: every instruction set and number of threads gives the same bits. That they are right is held against the shaders in
 * test_resolves.c. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "scene/pixel.h"
#include "shadow/asm/look_up.h"
#include "shadow/asm/pages.h"
#include "shadow/asm/place.h"
#include "shadow/asm/tree.h"
#include "studio.h"

enum {
    WIDTH = 173, /* no multiple of eight */
    HEIGHT = 61,
    PIXELS = WIDTH * HEIGHT,
    SLOTS = 6 * ASM_COLUMNS,
    TRIANGLES = 40,
};

static uint32_t next(uint32_t *seed)
{
    *seed = *seed * 1664525 + 1013904223;
    return *seed >> 8;
}

static float between(uint32_t *seed, float low, float high) { return low + (high - low) * (float)(next(seed) % 65536) / 65535; }

struct stage {
    struct asm_tree tree;
    struct asm_pages pages;
    struct asm_analysis analysis;
    struct asm_job job;
    struct pixel pixels[PIXELS];
    uint32_t ids[PIXELS];
    float visibility[PIXELS];
};

/* Side by side, they look along -z. */
static struct view look(double x, double fov, bool orthographic)
{
    return (struct view){.width = WIDTH,
                         .height = HEIGHT,
                         .orthographic = orthographic,
                         .eye = {x, 0, 5},
                         .right = {1, 0, 0},
                         .up = {0, 1, 0},
                         .forward = {0, 0, -1},
                         .left = -fov,
                         .right_edge = fov,
                         .bottom = -fov,
                         .top = fov,
                         .near = 1,
                         .far = 10};
}

static void grow(struct asm_tree *t, uint32_t *seed)
{
    for (int i = 0; i < 4000 && t->free_count; i++) {
        uint32_t slot = next(seed) % SLOTS, cell = next(seed) % 16;
        const struct asm_node *n = &t->nodes[slot];
        if (n->parent != ASM_FREE && n->level < ASM_LEVELS && !(n->children & 1u << cell))
            asm_tree_add(t, slot, cell);
    }
}

/* Depths and triangles at random about where the pixels lie, so that all answers come about. */
static void fill(struct stage *s, uint32_t seed)
{
    for (int i = 0; i < PIXELS; i++) {
        float depth = next(&seed) % 8 ? between(&seed, 4, 4.2f) : 0;
        s->pixels[i] = (struct pixel){.depth = depth};
        s->pixels[i].geometric = pixel_pack_geometric(between(&seed, -1, 1), between(&seed, -1, 1), between(&seed, 0.2f, 1));
        s->ids[i] = next(&seed) % TRIANGLES;
    }
    for (int i = 0; i < SLOTS * ASM_PAGE * ASM_PAGE; i++) {
        float depth = between(&seed, 4, 4.4f);
        s->pages.kept_depths[i] = !(next(&seed) % 8) ? 0 : s->job.depth.orthographic ? (10 - depth) / 9 : 1 / depth;
        s->pages.kept_ids[i] = next(&seed) % TRIANGLES;
    }
}

static struct stage *make_stage(bool orthographic, unsigned maps)
{
    struct stage *s = calloc(1, sizeof *s);
    struct error err = {0};
    struct view camera = look(0.2, 0.7, false),
                views[2] = {look(-0.4, orthographic ? 9 : 2.5, orthographic), look(0.7, 2.5, false)};
    const struct light light = {
        .kind = orthographic ? LIGHT_DIRECTIONAL : LIGHT_POINT, .position = {0.3, 0.2, 5}, .direction = {0, 0, -1}};
    uint32_t seed = 7;
    if (maps == 2)
        views[0].right_edge = 0; /* the other has the rest */
    assert_true(s && asm_tree_init(&s->tree, NULL, SLOTS, &err) && asm_pages_init(&s->pages, NULL, SLOTS, &err) &&
                asm_analysis_init(&s->analysis, NULL, SLOTS, &err));
    asm_tree_plant(&s->tree, views, maps);
    grow(&s->tree, &seed);
    s->job = (struct asm_job){.ids = s->ids,
                              .cells = s->tree.cells,
                              .depths = s->pages.kept_depths,
                              .page_ids = s->pages.kept_ids,
                              .detail = 8,
                              .grain = (float)(camera.top - camera.bottom) / HEIGHT};
    s->job.depth = (struct depth_job){.pixels = s->pixels,
                                      .visibility = s->visibility,
                                      .width = WIDTH,
                                      .height = HEIGHT,
                                      .bottom = HEIGHT,
                                      .rays = pixel_rays_of(&camera),
                                      .light = pixel_light_of(&light, camera.eye),
                                      .map_count = maps,
                                      .orthographic = orthographic,
                                      .slope = 0.1f};
    asm_place_block(&s->tree, &camera, &s->job.block);
    s->job.block.asm_counts[2] = 3;
    s->job.block.asm_counts[3] = 1;
    fill(s, 99);
    return s;
}

static void drop_stage(struct stage *s)
{
    asm_tree_finish(&s->tree);
    asm_pages_finish(&s->pages);
    asm_analysis_finish(&s->analysis);
    free(s);
}

struct outcome {
    float visibility[PIXELS];
    uint32_t counters[SLOTS * 18 + ASM_LEVELS + 1];
};

static void run(struct stage *s, const struct asm_kernel *kernel, unsigned threads, struct outcome *out)
{
    struct error err = {0};
    struct job_pool *pool = job_pool_create(threads, &err);
    assert_non_null(pool);
    asm_analysis_clear(&s->analysis);
    s->job.counters = asm_analysis_count(&s->analysis, 3);
    memset(s->visibility, 0xff, sizeof s->visibility);
    job_pool_for(pool, depth_job_count(&s->job.depth), kernel->resolve, &s->job);
    job_pool_for(pool, depth_job_count(&s->job.depth), kernel->analyse, &s->job);
    memcpy(out->visibility, s->visibility, sizeof out->visibility);
    memcpy(out->counters, s->analysis.kept, sizeof out->counters);
    job_pool_destroy(pool);
}

static void check_both_answers(const struct stage *s, const struct outcome *o)
{
    int lit = 0, dark = 0;
    uint32_t wanted = 0, worth = 0, boundary = 0;
    for (int i = 0; i < PIXELS; i++) {
        assert_true(o->visibility[i] == 0 || o->visibility[i] == 1);
        lit += o->visibility[i] == 1;
        dark += s->pixels[i].depth > 0 && o->visibility[i] == 0;
    }
    for (int i = 0; i < SLOTS * 16; i++)
        wanted += o->counters[i];
    for (int i = 0; i < SLOTS; i++)
        worth += o->counters[SLOTS * 16 + i];
    for (int i = 0; i <= ASM_LEVELS; i++)
        boundary += o->counters[SLOTS * 18 + i];
    assert_true(lit > PIXELS / 20 && dark > PIXELS / 20 && wanted > 300 && worth > 300 && boundary > 300);
}

static void test_same_bits(void **state)
{
    (void)state;
    static struct outcome one, other;
    for (int k = 0; k < 3; k++) {
        struct stage *s = make_stage(k == 0, k == 2 ? 2 : 1);
        run(s, &asm_plain, 1, &one);
        check_both_answers(s, &one);
        run(s, &asm_plain, 4, &other);
        assert_memory_equal(&one, &other, sizeof one);
#ifdef __x86_64__
        if (asm_avx2.resolve && __builtin_cpu_supports("avx2")) {
            run(s, &asm_avx2, 2, &other);
            assert_memory_equal(&one, &other, sizeof one);
        }
#endif
        /* It can fail: another texel, another turn. */
        s->pages.kept_depths[5 * 256 + 7] += 0.01f;
        s->job.block.asm_counts[3] = 2;
        run(s, &asm_plain, 1, &other);
        assert_memory_not_equal(one.counters, other.counters, sizeof one.counters);
        drop_stage(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_bits)};
    struct studio studio; /* what is freed asks for a GL context, even where there was nothing */
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return failed;
}
