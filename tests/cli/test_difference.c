#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "comparison.h"
#include "difference.h"

/* Four pixels: right, leak, acne, no receiver; under two lights, of which the second is right everywhere. */
static uint8_t picture[16] = {200, 200, 200, 255, 200, 200, 200, 255, 200, 200, 200, 255, 200, 200, 200, 255};
static float tested[4] = {1, 1, 0, 0}, truth[4] = {1, 0, 0.75f, 1}, lit[4] = {1, 1, 1, 1};
static uint8_t receiver[4] = {1, 1, 1, 0};

static struct comparison comparison(void)
{
    struct comparison c = {.width = 4, .height = 1, .light_count = 2, .picture = picture};
    c.tested[0] = tested, c.truth[0] = truth, c.receiver[0] = receiver;
    c.tested[1] = lit, c.truth[1] = lit, c.receiver[1] = receiver;
    return c;
}

static void paints_leaks_orange_and_acne_blue(void **state)
{
    (void)state;
    struct comparison c = comparison();
    uint8_t out[16];
    difference_paint(&c, out);
    assert_memory_equal(out, ((uint8_t[]){100, 100, 100, 255}), 4);
    assert_memory_equal(out + 4, ((uint8_t[]){255, 130, 0, 255}), 4);
    assert_true(out[10] > out[8] && out[10] > 200 && out[8] < 100);
    assert_memory_equal(out + 12, ((uint8_t[]){100, 100, 100, 255}), 4);
}

static void gives_the_numbers(void **state)
{
    (void)state;
    struct comparison c = comparison();
    float out[16];
    const float expected[16] = {1, 1, 0, 1, 1, 0, 1, 1, 0, 0.75f, -0.75f, 1, 0, 0, 0, 0};
    difference_numbers(&c, out);
    for (int i = 0; i < 16; i++)
        assert_true(out[i] == expected[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(paints_leaks_orange_and_acne_blue), cmocka_unit_test(gives_the_numbers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
