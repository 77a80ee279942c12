#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "bench/turns.h"

/* "AB AB" for two cells of two turns. */
static void written(const unsigned *counts, size_t cells, char *out)
{
    size_t total;
    struct turn *order = turns_order(counts, cells, &total);
    uint32_t round = 0;
    for (size_t i = 0; i < total; i++) {
        if (order[i].round != round)
            *out++ = ' ';
        round = order[i].round;
        *out++ = (char)('A' + order[i].cell);
    }
    *out = 0;
    free(order);
}

static void equal_counts_alternate(void **state)
{
    (void)state;
    char text[64];
    written((const unsigned[]){3, 3}, 2, text);
    assert_string_equal(text, "AB AB AB");
    written((const unsigned[]){2, 2, 2}, 3, text);
    assert_string_equal(text, "ABC ABC");
}

static void fewer_turns_are_spread(void **state)
{
    (void)state;
    char text[64];
    written((const unsigned[]){4, 2}, 2, text);
    assert_string_equal(text, "A AB A AB");
    written((const unsigned[]){5, 1, 0}, 3, text);
    assert_string_equal(text, "A A A A AB");
}

static void every_cell_gets_its_turns(void **state)
{
    (void)state;
    const unsigned counts[] = {7, 3, 20, 1, 11};
    unsigned got[5] = {0};
    size_t total;
    struct turn *order = turns_order(counts, 5, &total);
    assert_int_equal(total, 42);
    for (size_t i = 0; i < total; i++)
        got[order[i].cell]++;
    assert_memory_equal(got, counts, sizeof got);
    free(order);
}

static void nothing_to_do(void **state)
{
    (void)state;
    size_t total = 1;
    assert_null(turns_order((const unsigned[]){0, 0}, 2, &total));
    assert_int_equal(total, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_counts_alternate),
        cmocka_unit_test(fewer_turns_are_spread),
        cmocka_unit_test(every_cell_gets_its_turns),
        cmocka_unit_test(nothing_to_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
