#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "reference/flicker.h"

enum { N = 20 };

static const uint8_t *everywhere(void)
{
    static uint8_t all[N];
    memset(all, 1, sizeof all);
    return all;
}

static double mean(const struct flicker *f, double sum) { return f->count ? sum / (double)f->count : 0; }

/* Frame `t` of pictures whose pixels all have the value of one of these. */
static float still(unsigned t) { return (void)t, 0.5f; }
static float fade(unsigned t) { return (float)t / 16; }
static float blink(unsigned t) { return t % 2 ? 1 : 0; }
static float step(unsigned t) { return t < 4 ? 0 : 1; }
static float flash(unsigned t) { return t == 3 ? 0 : 1; }

static struct flicker played(float (*tested)(unsigned), float (*truth)(unsigned), unsigned frames)
{
    struct flicker f;
    float a[N], b[N];
    assert_true(flicker_init(&f, N));
    for (unsigned t = 0; t < frames; t++) {
        for (int i = 0; i < N; i++) {
            a[i] = tested(t);
            b[i] = truth(t);
        }
        flicker_add(&f, a, b, everywhere());
    }
    flicker_finish(&f);
    return f;
}

static void even_change_is_none(void **state)
{
    (void)state;
    struct flicker f = played(still, fade, 8);
    assert_int_equal(f.count, 6 * N);
    assert_true(f.tested_sum == 0 && f.truth_sum == 0);
    f = played(still, still, 2);
    assert_true(f.count == 0 && f.tested_sum == 0);
}

static void what_blinks_flickers(void **state)
{
    (void)state;
    struct flicker f = played(blink, still, 8);
    assert_true(mean(&f, f.tested_sum) == 2 && f.truth_sum == 0);
    f = played(flash, step, 8);
    assert_true(f.tested_sum == 4 * N); /* 1, then 2, then 1 */
    assert_true(f.truth_sum == 2 * N);  /* an edge that passes once: 1, then 1 */
}

/* A pixel counts where it is a receiver in all three frames, and has its own past. */
static void receivers_of_three_frames_count(void **state)
{
    (void)state;
    struct flicker f;
    float v[N] = {0};
    uint8_t receiver[N] = {0};
    assert_true(flicker_init(&f, N));
    receiver[3] = receiver[7] = 1;
    for (unsigned t = 0; t < 5; t++) {
        v[3] = blink(t);
        v[5] = blink(t + 1); /* no receiver */
        v[7] = t < 2 ? 0 : 1;
        receiver[7] = t != 3;
        flicker_add(&f, v, v, receiver);
    }
    flicker_finish(&f);
    assert_int_equal(f.count, 3 + 1);
    assert_true(f.tested_sum == 3 * 2 + 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_change_is_none),
        cmocka_unit_test(what_blinks_flickers),
        cmocka_unit_test(receivers_of_three_frames_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
