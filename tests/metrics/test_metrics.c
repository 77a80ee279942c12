#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "reference/metrics.h"

enum { WIDTH = 40, HEIGHT = 30, N = WIDTH * HEIGHT };

struct pictures {
    float tested[N], reference[N];
    uint8_t receiver[N], one[N];
};

static struct metrics_input input_of(const struct pictures *p)
{
    return (struct metrics_input){
        .width = WIDTH,
        .height = HEIGHT,
        .visibility = p->tested,
        .reference = p->reference,
        .receiver = p->receiver,
        .wrong_samples = -1,
    };
}

static struct metrics measured(const struct pictures *p)
{
    struct metrics_input in = input_of(p);
    struct metrics m;
    assert_true(metrics_measure(&in, &m));
    return m;
}

static bool near(double a, double b) { return fabs(a - b) < 1e-4; }

/* Lit where x cos(angle) + y sin(angle) > offset, with a ramp one pixel wide: the contour is the line itself. */
static void half_plane(float out[N], double angle, double offset)
{
    for (int i = 0; i < N; i++) {
        double at = i % WIDTH * cos(angle) + i / WIDTH * sin(angle) - offset;
        out[i] = (float)fmin(fmax(at * 0.25 + 0.5, 0), 1);
    }
}

static struct pictures all_lit(void)
{
    struct pictures p;
    for (int i = 0; i < N; i++) {
        p.tested[i] = p.reference[i] = 1;
        p.receiver[i] = 1;
        p.one[i] = 0;
    }
    return p;
}

static void equal_pictures_have_no_error(void **state)
{
    (void)state;
    struct pictures p = all_lit();
    half_plane(p.reference, 0.3, 20);
    memcpy(p.tested, p.reference, sizeof p.tested);
    struct metrics m = measured(&p);
    assert_int_equal(m.receivers, N);
    assert_int_equal(m.misclassified + m.leaks + m.acne, 0);
    assert_true(m.rmse == 0 && m.max_abs == 0 && m.boundary.rmse == 0 && m.boundary.pixels > 0);
    assert_true(m.boundary.edge_shift_mean < 1e-9 && m.boundary.edge_shift_max < 1e-9);
    assert_true(isnan(m.rmse_one_receiver));
    assert_int_equal(m.wrong_samples, -1);
}

static void nothing_to_measure_is_zero(void **state)
{
    (void)state;
    struct pictures p = all_lit();
    memset(p.receiver, 0, sizeof p.receiver);
    p.tested[5] = 0;
    struct metrics m = measured(&p);
    assert_true(m.receivers == 0 && m.misclassified_fraction == 0 && m.rmse == 0 && m.max_abs == 0);
    assert_true(m.boundary.pixels == 0 && m.boundary.edge_shift_max == 0);
}

/* Ten lit receivers in a dark sea are leaks, one at the shadow's edge is not. */
static void leaks_and_acne_are_two_pixels_inside(void **state)
{
    (void)state;
    struct pictures p = all_lit();
    for (int i = 0; i < N; i++)
        p.tested[i] = p.reference[i] = i % WIDTH < 20 ? 0 : 1;
    p.tested[10 * WIDTH + 10] = 1;     /* leak */
    p.tested[0] = 0.75f;               /* leak in the picture's corner */
    p.tested[12 * WIDTH + 18] = 1;     /* two from the edge: its 5 x 5 sees both */
    p.tested[14 * WIDTH + 17] = 1;     /* three from the edge: leak */
    p.tested[10 * WIDTH + 30] = 0;     /* acne */
    p.tested[20 * WIDTH + 21] = 0.25f; /* at the edge */
    p.tested[22 * WIDTH + 30] = 0.5f;  /* off by exactly 0.5: not misclassified */
    struct metrics m = measured(&p);
    assert_int_equal(m.misclassified, 6);
    assert_int_equal(m.leaks, 3);
    assert_int_equal(m.acne, 1);
    assert_true(near(m.misclassified_fraction, 6.0 / N));
    assert_true(m.max_abs == 1);
    assert_true(near(m.rmse, sqrt((1 + 0.5625 + 1 + 1 + 1 + 0.5625 + 0.25) / N)));
    assert_int_equal(m.boundary.pixels, 2 * HEIGHT);
    assert_true(m.boundary.rmse == 0);
}

static void other_receivers_alone_make_classes(void **state)
{
    (void)state;
    struct pictures p = all_lit();
    for (int i = 0; i < N; i++) {
        p.tested[i] = p.reference[i] = i % WIDTH < 20 ? 0 : 1;
        p.receiver[i] = i % WIDTH < 20;
    }
    p.tested[12 * WIDTH + 19] = 1;
    struct metrics m = measured(&p);
    assert_int_equal(m.receivers, 20 * HEIGHT);
    assert_int_equal(m.leaks, 1);
    assert_int_equal(m.boundary.pixels, 0);
    assert_true(m.boundary.edge_shift_max > 0); /* the tested picture has an edge of its own round that pixel */
}

static void a_moved_half_plane_has_the_shift_it_was_moved_by(void **state)
{
    (void)state;
    static const double angles[] = {0, M_PI / 2, 0.4, 2.1, 3.3};
    static const double moved[] = {3.0 / 32, 1, 2.5, 1.0 / 32};
    for (size_t a = 0; a < sizeof angles / sizeof angles[0]; a++)
        for (size_t k = 0; k < sizeof moved / sizeof moved[0]; k++) {
            struct pictures p = all_lit();
            double middle = WIDTH / 2 * cos(angles[a]) + HEIGHT / 2 * sin(angles[a]);
            half_plane(p.reference, angles[a], middle + 0.2);
            half_plane(p.tested, angles[a], middle + 0.2 + moved[k]);
            struct metrics m = measured(&p);
            /* At the picture's border the other line may end before its nearest point: the mean may be a little more. */
            bool straight = a < 2;
            assert_true(fabs(m.boundary.edge_shift_mean - 32 * moved[k]) < (straight ? 1e-3 : 0.02 * 32 * moved[k] + 1e-3));
            assert_true(fabs(m.boundary.edge_shift_p95 - 32 * moved[k]) < (straight ? 1e-3 : 0.3 * 32 * moved[k]));
            assert_true(m.boundary.edge_shift_max >= m.boundary.edge_shift_p95);
        }
}

static void shifts_are_capped_at_eight_pixels(void **state)
{
    (void)state;
    struct pictures p = all_lit();
    half_plane(p.reference, 0, 20);
    struct metrics m = measured(&p);
    assert_true(m.boundary.edge_shift_mean == 256 && m.boundary.edge_shift_max == 256);
    half_plane(p.tested, 0, 30);
    m = measured(&p);
    assert_true(m.boundary.edge_shift_mean == 256 && m.boundary.edge_shift_p95 == 256);
    /* No edge in the reference, one in the tested picture: the other way round counts in the maximum alone. */
    p = all_lit();
    half_plane(p.tested, 0, 20);
    m = measured(&p);
    assert_true(m.boundary.edge_shift_mean == 0 && m.boundary.edge_shift_max == 256);
}

/* A second, far edge in the tested picture moves nothing but the Hausdorff distance. */
static void hausdorff_looks_both_ways(void **state)
{
    (void)state;
    struct pictures p = all_lit();
    for (int i = 0; i < N; i++) {
        p.reference[i] = i % WIDTH < 10 ? 0 : 1;
        p.tested[i] = i % WIDTH < 10 || i % WIDTH == 14 ? 0 : 1;
    }
    struct metrics m = measured(&p);
    assert_true(m.boundary.edge_shift_mean == 0 && m.boundary.edge_shift_p95 == 0);
    assert_true(near(m.boundary.edge_shift_max, 5 * 32));
}

static void binary_edges_lie_between_pixels(void **state)
{
    (void)state;
    struct pictures p = all_lit();
    for (int i = 0; i < N; i++) {
        p.reference[i] = i % WIDTH < 10 ? 0 : 1;
        p.tested[i] = i % WIDTH < 12 ? 0 : 1;
    }
    struct metrics m = measured(&p);
    assert_true(near(m.boundary.edge_shift_mean, 64) && near(m.boundary.edge_shift_max, 64));
    assert_int_equal(m.misclassified, 2 * HEIGHT);
}

static void single_triangles_are_counted(void **state)
{
    (void)state;
    struct pictures p = all_lit();
    p.tested[3] = 0.5f;
    p.one[3] = p.one[4] = 1;
    p.tested[7] = 0;
    struct metrics_input in = input_of(&p);
    struct metrics m;
    in.one_triangle = p.one;
    assert_true(metrics_measure(&in, &m));
    assert_true(near(m.rmse_one_receiver, sqrt(0.25 / 2)));
}

/* A sample that is wrong both ways counts once. */
static void wrong_samples_are_counted(void **state)
{
    (void)state;
    uint32_t a[2][N] = {0}, b[2][N] = {0};
    const struct sample_masks tested = {a[0], a[1]}, truth = {b[0], b[1]};
    assert_int_equal(metrics_wrong_samples(&tested, &truth, N), 0);
    a[0][3] = b[0][3] = 0xff;
    a[1][3] = 0x0f;
    b[1][3] = 0x3c; /* bits 0, 1, 4, 5 */
    b[0][9] = b[1][9] = 1u << 31;
    assert_int_equal(metrics_wrong_samples(&tested, &truth, N), 5);
    assert_int_equal(metrics_wrong_samples(&tested, &truth, 9), 4);
    struct pictures p = all_lit();
    struct metrics_input in = input_of(&p);
    struct metrics m;
    in.wrong_samples = 5;
    assert_true(metrics_measure(&in, &m));
    assert_int_equal(m.wrong_samples, 5);
}

static void lights_pool(void **state)
{
    (void)state;
    struct pictures p = all_lit(), q = all_lit();
    half_plane(p.reference, 0, 20);
    half_plane(p.tested, 0, 21);
    half_plane(q.reference, M_PI / 2, 15);
    half_plane(q.tested, M_PI / 2, 18);
    struct metrics_input in_p = input_of(&p), in_q = input_of(&q);
    struct metrics m_p, m_q;
    struct metrics_pool pool;
    metrics_pool_init(&pool);
    assert_true(metrics_pool_add(&pool, &in_p, &m_p));
    assert_true(near(pool.total.boundary.edge_shift_mean, 32) && near(pool.total.rmse, m_p.rmse));
    assert_true(metrics_pool_add(&pool, &in_q, &m_q));
    const struct metrics *t = &pool.total;
    assert_int_equal(t->receivers, 2 * N);
    assert_int_equal(t->misclassified, m_p.misclassified + m_q.misclassified);
    assert_true(near(t->rmse, sqrt((m_p.rmse * m_p.rmse + m_q.rmse * m_q.rmse) / 2)));
    assert_true(near(t->boundary.edge_shift_mean, (32.0 * HEIGHT + 96.0 * WIDTH) / (HEIGHT + WIDTH)));
    assert_true(near(t->boundary.edge_shift_p95, 96) && near(t->boundary.edge_shift_max, 96));
    assert_true(isnan(t->rmse_one_receiver) && t->wrong_samples == -1);
    metrics_pool_finish(&pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_pictures_have_no_error),
        cmocka_unit_test(nothing_to_measure_is_zero),
        cmocka_unit_test(leaks_and_acne_are_two_pixels_inside),
        cmocka_unit_test(other_receivers_alone_make_classes),
        cmocka_unit_test(a_moved_half_plane_has_the_shift_it_was_moved_by),
        cmocka_unit_test(shifts_are_capped_at_eight_pixels),
        cmocka_unit_test(hausdorff_looks_both_ways),
        cmocka_unit_test(binary_edges_lie_between_pixels),
        cmocka_unit_test(single_triangles_are_counted),
        cmocka_unit_test(wrong_samples_are_counted),
        cmocka_unit_test(lights_pool),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
