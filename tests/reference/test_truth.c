/* The reference against the second opinion, bit by bit; and how often plain Embree is wrong on the same pictures. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "hard_scenes.h"
#include "rational.h"
#include "reference/reference.h"
#include "trace/tracer.h"

enum { POINT_WIDTH = 36, POINT_HEIGHT = 24, SAMPLES_WIDTH = 6, SAMPLES_HEIGHT = 4 };

struct totals {
    uint64_t points, samples, wrong_points, wrong_samples, embree_points, embree_samples, exact;
};

struct setting {
    struct scene *scene;
    struct view view;
    struct light light;
    struct reference *reference;
    struct tracer *tracer;
    struct job_pool *pool;
    struct totals *totals;
};

static struct light light_of(const struct hard_scene *hard, enum light_kind kind)
{
    struct light light = made_light(kind, hard->light, hard->target);
    light.outer = 0.5;
    light.range = kind == LIGHT_SPOT ? 5.25 : 0;
    return light;
}

/* A grid scene is seen so that pixel centres lie on multiples of 1/8, and samples on multiples of 1/32: some of both on its integers. */
static struct view view_of(const struct hard_scene *hard, bool orthographic, uint32_t width, uint32_t height)
{
    struct camera camera = made_camera(hard->eye, hard->target, 0.7);
    camera.orthographic = orthographic || hard->grid;
    camera.ymag = 1.4;
    camera.far = 5.5;
    if (hard->grid) {
        bool samples = width == SAMPLES_WIDTH;
        camera.ymag = height / (samples ? 2.0 : 16.0);
        camera.far = 20;
        camera.eye.x += samples ? 1.0 / 64 : 1.0 / 16;
        camera.eye.y += samples ? -1.0 / 64 : -1.0 / 16;
    }
    return view_from_camera(&camera, width, height);
}

struct rows {
    const struct setting *setting;
    const uint32_t *ids;
    enum rational_answer *answers;
    uint32_t *receivers, *lit;
    uint8_t *one;
};

static void point_row(void *context, size_t y, unsigned worker)
{
    (void)worker;
    struct rows *rows = context;
    const struct setting *s = rows->setting;
    struct rational *rational = rational_create(s->scene);
    for (uint32_t x = 0; x < s->view.width; x++) {
        size_t at = y * s->view.width + x;
        rows->answers[at] = rational_light(rational, &s->view, &s->light, rows->ids[at], x + 0.5, (double)y + 0.5);
    }
    rational_destroy(rational);
}

static void check_point(const struct setting *s)
{
    enum { N = POINT_WIDTH * POINT_HEIGHT };
    static uint32_t ids[N];
    static float visibility[N], plain[N];
    static uint8_t receiver[N];
    static enum rational_answer answers[N];
    struct reference_counts counts;
    struct rows rows = {.setting = s, .ids = ids, .answers = answers};
    tracer_camera(s->tracer, &s->view, s->pool, ids, NULL);
    assert_true(reference_point(s->reference, &s->view, &s->light, ids, s->pool, NULL, visibility, receiver, &counts));
    tracer_shadow_point(s->tracer, &s->view, &s->light, ids, s->pool, plain);
    job_pool_for(s->pool, s->view.height, point_row, &rows);
    for (size_t i = 0; i < N; i++) {
        s->totals->wrong_points +=
            visibility[i] != (answers[i] == RATIONAL_LIT) || receiver[i] != (answers[i] != RATIONAL_NO_RECEIVER);
        s->totals->embree_points += plain[i] != (answers[i] == RATIONAL_LIT);
        s->totals->points += answers[i] != RATIONAL_NO_RECEIVER;
    }
    s->totals->exact += counts.exact;
}

static void sample_row(void *context, size_t y, unsigned worker)
{
    (void)worker;
    struct rows *rows = context;
    const struct setting *s = rows->setting;
    struct rational *rational = rational_create(s->scene);
    for (uint32_t x = 0; x < s->view.width; x++) {
        size_t at = y * s->view.width + x;
        uint32_t first = SCENE_NONE;
        bool one = true;
        rows->receivers[at] = rows->lit[at] = 0;
        for (unsigned i = 0; i < 32; i++) {
            double px = x + (double)view_samples32[i][0], py = (double)y + (double)view_samples32[i][1];
            uint32_t id = rational_visible(rational, &s->view, px, py);
            enum rational_answer answer = rational_light(rational, &s->view, &s->light, id, px, py);
            rows->receivers[at] |= (uint32_t)(answer != RATIONAL_NO_RECEIVER) << i;
            rows->lit[at] |= (uint32_t)(answer == RATIONAL_LIT) << i;
            first = i ? first : id;
            one &= id == first;
        }
        rows->one[at] = one && first != SCENE_NONE;
    }
    rational_destroy(rational);
}

static void check_samples(const struct setting *s)
{
    enum { N = SAMPLES_WIDTH * SAMPLES_HEIGHT };
    uint32_t receivers[N], lit[N], plain_receivers[N], plain_lit[N], true_receivers[N], true_lit[N];
    uint8_t one[N], true_one[N];
    struct reference_counts counts;
    struct rows rows = {.setting = s, .receivers = true_receivers, .lit = true_lit, .one = true_one};
    assert_true(reference_samples32(s->reference, &s->view, &s->light, s->pool, NULL, receivers, lit, one, &counts));
    tracer_shadow_samples32(s->tracer, &s->view, &s->light, s->pool, plain_receivers, plain_lit);
    job_pool_for(s->pool, s->view.height, sample_row, &rows);
    for (size_t i = 0; i < N; i++) {
        uint32_t wrong = (receivers[i] ^ true_receivers[i]) | (lit[i] ^ true_lit[i]);
        uint32_t plain = (plain_receivers[i] ^ true_receivers[i]) | (plain_lit[i] ^ true_lit[i]);
        s->totals->wrong_samples += (unsigned)__builtin_popcount(wrong) + (one[i] != true_one[i]);
        s->totals->embree_samples += (unsigned)__builtin_popcount(plain);
        s->totals->samples += (unsigned)__builtin_popcount(true_receivers[i]);
    }
    s->totals->exact += counts.exact;
}

static void check_scene(const struct hard_scene *hard, struct totals *totals)
{
    struct error err = {0};
    struct setting s = {.scene = hard->make(), .totals = totals};
    s.pool = job_pool_create(2, &err);
    s.reference = reference_create(s.scene, 1, &err);
    s.tracer = tracer_create(s.scene, 1, &err);
    assert_non_null(s.reference);
    assert_true(reference_bytes(s.reference) > 0);
    for (int kind = LIGHT_DIRECTIONAL; kind <= LIGHT_SPOT; kind++) {
        bool orthographic = kind == LIGHT_POINT;
        s.light = light_of(hard, (enum light_kind)kind);
        s.view = view_of(hard, orthographic, POINT_WIDTH, POINT_HEIGHT);
        check_point(&s);
        s.view = view_of(hard, !orthographic, SAMPLES_WIDTH, SAMPLES_HEIGHT);
        check_samples(&s);
    }
    tracer_destroy(s.tracer);
    reference_destroy(s.reference);
    job_pool_destroy(s.pool);
    scene_destroy(s.scene);
}

static void the_reference_is_the_truth(void **state)
{
    (void)state;
    struct totals sum = {0};
    for (size_t i = 0; i < hard_scene_count; i++) {
        struct totals t = {0};
        check_scene(&hard_scenes[i], &t);
        print_message(
            "%-16s receivers %5zu + %5zu samples; reference wrong %zu + %zu; plain Embree wrong %zu + %zu; decided exactly %zu\n",
            hard_scenes[i].name, (size_t)t.points, (size_t)t.samples, (size_t)t.wrong_points, (size_t)t.wrong_samples,
            (size_t)t.embree_points, (size_t)t.embree_samples, (size_t)t.exact);
        sum.points += t.points;
        sum.samples += t.samples;
        sum.wrong_points += t.wrong_points;
        sum.wrong_samples += t.wrong_samples;
        sum.embree_points += t.embree_points;
        sum.embree_samples += t.embree_samples;
        sum.exact += t.exact;
    }
    assert_true(sum.points > 10000 && sum.samples > 10000);
    assert_int_equal(sum.wrong_points, 0);
    assert_int_equal(sum.wrong_samples, 0);
    /* The comparison can fail: it finds plain Embree's errors, and the scenes do reach exact arithmetic. */
    assert_true(sum.embree_points > 0);
    assert_true(sum.embree_samples > 0);
    assert_true(sum.exact > 100);
}

/* Moves an occluder behind the reference's back: the comparer must see it. */
static void a_wrong_reference_is_found(void **state)
{
    (void)state;
    const struct hard_scene *hard = &hard_scenes[0];
    struct error err = {0};
    struct totals totals = {0};
    struct scene *other = hard->make();
    struct setting s = {.scene = hard->make(), .totals = &totals, .view = view_of(hard, false, POINT_WIDTH, POINT_HEIGHT)};
    for (size_t i = 0; i < 9; i++)
        other->positions[i][0] += 0.25f;
    s.light = light_of(hard, LIGHT_POINT);
    s.pool = job_pool_create(2, &err);
    s.tracer = tracer_create(s.scene, 1, &err);
    s.reference = reference_create(other, 1, &err);
    check_point(&s);
    assert_true(totals.wrong_points > 0);
    s.view = view_of(hard, false, SAMPLES_WIDTH, SAMPLES_HEIGHT);
    check_samples(&s);
    assert_true(totals.wrong_samples > 0);
    reference_destroy(s.reference);
    tracer_destroy(s.tracer);
    job_pool_destroy(s.pool);
    scene_destroy(other);
    scene_destroy(s.scene);
}

static bool stop_at_once(void *calls, double done)
{
    assert_true(done >= 0 && done <= 1);
    return ++*(int *)calls < 2;
}

static void it_can_be_stopped(void **state)
{
    (void)state;
    enum { SIDE = 96 };
    static float visibility[SIDE * SIDE];
    static uint32_t ids[SIDE * SIDE];
    const struct hard_scene *hard = &hard_scenes[0];
    struct error err = {0};
    int calls = 0;
    struct reference_progress progress = {stop_at_once, &calls};
    struct scene *scene = hard->make();
    struct view view = view_of(hard, false, SIDE, SIDE);
    struct light light = light_of(hard, LIGHT_POINT);
    struct job_pool *pool = job_pool_create(1, &err);
    struct reference *reference = reference_create(scene, 1, &err);
    memset(ids, 0xff, sizeof ids);
    assert_false(reference_point(reference, &view, &light, ids, pool, &progress, visibility, NULL, NULL));
    assert_int_equal(calls, 2);
    reference_destroy(reference);
    job_pool_destroy(pool);
    scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_reference_is_the_truth),
        cmocka_unit_test(a_wrong_reference_is_found),
        cmocka_unit_test(it_can_be_stopped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
