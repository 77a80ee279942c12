#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "stream_view.h"

#define START 1000000ull

static struct stream_view view_at(uint64_t now)
{
    struct stream_view v = {.id = 1};
    struct view_state state = {.quality = 75};
    enum drop_reason reason;
    assert_false(stream_view_update(&v, &state, now, &reason)); /* nothing was wanted before */
    return v;
}

static enum stream_need need(const struct stream_view *v, uint64_t now)
{
    uint64_t due = 0;
    return stream_view_need(v, now, &due);
}

static uint64_t show(struct stream_view *v, bool still, uint64_t now)
{
    uint64_t frame = stream_view_submit(v, still, now);
    stream_view_sent(v, frame, 100, 5000, now + 10);
    return frame;
}

/* One frame for a new state, one still frame after the pause, then nothing for ever. */
static void test_still_view_rests(void **state)
{
    (void)state;
    struct stream_view v = view_at(START);
    assert_int_equal(need(&v, START), STREAM_FRAME);
    assert_true(stream_view_ack(&v, show(&v, false, START), START + 20));
    uint64_t due = 0;
    assert_int_equal(stream_view_need(&v, START + 1000, &due), STREAM_LATER);
    assert_int_equal(due, START + STREAM_STILL_AFTER_US);
    assert_int_equal(need(&v, due), STREAM_STILL);
    show(&v, true, due);
    assert_int_equal(need(&v, due + 3600000000ull), STREAM_NOTHING);
}

/* A progressive system's still view goes on until it has converged. */
static void test_unfinished_view_goes_on(void **state)
{
    (void)state;
    struct stream_view v = view_at(START);
    assert_true(stream_view_ack(&v, show(&v, false, START), START + 20));
    v.unfinished = true;
    assert_int_equal(need(&v, START + 1000), STREAM_FRAME);
    assert_true(stream_view_ack(&v, show(&v, false, START + 1000), START + 1020));
    v.unfinished = false;
    assert_int_equal(need(&v, START + 2000), STREAM_LATER);
}

static void test_credit(void **state)
{
    (void)state;
    struct stream_view v = view_at(START);
    struct view_state next = {.quality = 50};
    enum drop_reason reason;
    uint64_t first = show(&v, false, START);
    assert_false(stream_view_update(&v, &next, START + 1, &reason));
    uint64_t second = show(&v, false, START + 1);
    assert_false(stream_view_update(&v, &next, START + 2, &reason));
    assert_int_equal(need(&v, START + 3), STREAM_NO_CREDIT);
    /* A state that nobody will see is dropped, and counted for the right reason. */
    assert_true(stream_view_update(&v, &next, START + 4, &reason));
    assert_int_equal(reason, DROP_CREDIT);
    assert_int_equal(v.dropped, 1);
    assert_true(stream_view_ack(&v, first, START + 500));
    assert_int_equal(v.rtt_us, 490);
    assert_int_equal(need(&v, START + 5), STREAM_FRAME);
    assert_true(stream_view_ack(&v, second, START + 600));
    assert_int_equal(v.in_flight_count, 0);
}

static void test_ack_is_cumulative_and_checked(void **state)
{
    (void)state;
    struct stream_view v = view_at(START);
    assert_false(stream_view_ack(&v, 0, START));
    assert_false(stream_view_ack(&v, 1, START));
    stream_view_submit(&v, false, START);
    assert_false(stream_view_ack(&v, 1, START)); /* rendered, not sent */
    stream_view_sent(&v, 1, 0, 10, START);
    show(&v, false, START);
    assert_false(stream_view_ack(&v, 3, START));
    assert_true(stream_view_ack(&v, 2, START + 1));
    assert_int_equal(v.in_flight_count, 0);
    assert_true(stream_view_ack(&v, 1, START + 1)); /* late, harmless */
}

/* One frame under way, unless acknowledgements take longer than frames take to make. */
static void test_one_frame_at_a_time(void **state)
{
    (void)state;
    struct stream_view v = view_at(START);
    struct view_state next = {0};
    enum drop_reason reason;
    uint64_t first = stream_view_submit(&v, false, START);
    assert_true(stream_view_may_send(&v));
    stream_view_sent(&v, first, 1000, 5000, START);
    stream_view_update(&v, &next, START, &reason);
    uint64_t second = stream_view_submit(&v, false, START);
    assert_false(stream_view_may_send(&v));
    v.last.frame_ms = 30;
    v.rtt_us = STREAM_ONE_AT_A_TIME_US + 5000;
    assert_false(stream_view_may_send(&v));
    v.rtt_us = 80000;
    assert_true(stream_view_may_send(&v));
    v.rtt_us = 0;
    /* Waiting makes it stale only when there is something newer. */
    assert_false(stream_view_is_stale(&v, second, START, START + 10 * STREAM_STALE_US));
    stream_view_update(&v, &next, START, &reason);
    assert_false(stream_view_is_stale(&v, second, START, START + STREAM_STALE_US));
    assert_true(stream_view_is_stale(&v, second, START, START + STREAM_STALE_US + 1));
    assert_true(stream_view_ack(&v, first, START + 500));
    assert_true(stream_view_may_send(&v));
    stream_view_lost(&v, second);
    assert_int_equal(v.in_flight_count, 0);
}

static void test_lost_frame_returns_credit(void **state)
{
    (void)state;
    struct stream_view v = view_at(START);
    uint64_t lost = stream_view_submit(&v, false, START);
    uint64_t kept = show(&v, false, START);
    stream_view_lost(&v, lost);
    assert_int_equal(v.in_flight_count, 1);
    assert_true(stream_view_ack(&v, kept, START + 1));
    stream_view_lost(&v, 99);
    assert_int_equal(v.in_flight_count, 0);
}

static void test_blocked_socket(void **state)
{
    (void)state;
    struct stream_view v = view_at(START);
    struct view_state next = {0};
    enum drop_reason reason;
    v.blocked = true;
    assert_int_equal(need(&v, START), STREAM_BLOCKED);
    assert_true(stream_view_update(&v, &next, START, &reason));
    assert_int_equal(reason, DROP_SOCKET);
    v.blocked = false;
    assert_int_equal(need(&v, START), STREAM_FRAME);
}

static void test_frame_rate(void **state)
{
    (void)state;
    struct stream_view v = view_at(START);
    v.wanted.fps_max = 10;
    struct view_state next = v.wanted;
    enum drop_reason reason;
    stream_view_ack(&v, show(&v, false, START), START + 20);
    stream_view_update(&v, &next, START + 1000, &reason);
    uint64_t due = 0;
    assert_int_equal(stream_view_need(&v, START + 1000, &due), STREAM_LATER);
    assert_int_equal(due, START + 100000);
    assert_int_equal(need(&v, due), STREAM_FRAME);
}

static void test_pause(void **state)
{
    (void)state;
    struct stream_view v = view_at(START);
    struct view_state paused = {.paused = true}, awake = {0};
    enum drop_reason reason;
    stream_view_update(&v, &paused, START, &reason);
    assert_int_equal(need(&v, START + 10), STREAM_NOTHING);
    assert_false(stream_view_update(&v, &awake, START + 20, &reason)); /* nobody missed it */
    assert_int_equal(need(&v, START + 20), STREAM_FRAME);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_still_view_rests),
        cmocka_unit_test(test_unfinished_view_goes_on),
        cmocka_unit_test(test_credit),
        cmocka_unit_test(test_ack_is_cumulative_and_checked),
        cmocka_unit_test(test_one_frame_at_a_time),
        cmocka_unit_test(test_lost_frame_returns_credit),
        cmocka_unit_test(test_blocked_socket),
        cmocka_unit_test(test_frame_rate),
        cmocka_unit_test(test_pause),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
