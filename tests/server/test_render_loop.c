#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/job_pool.h"
#include "fake_renderer.h"
#include "render_loop.h"
#include "scene_store.h"

#define PATIENCE_MS 20000
#define QUIET_MS    60 /* long enough for a frame that must not come */

struct fixture {
    struct job_pool *pool;
    struct encode_pool *encoders;
    struct render_loop *loop;
    struct metrics metrics;
    struct scene_entry scene;
    atomic_bool lost;
    struct encode_job *jobs; /* taken and not looked at yet */
};

static void on_done(void *context)
{
    struct fixture *f = context;
    if (f->loop)
        render_loop_kick(f->loop);
}

static void on_lost(void *context) { atomic_store(&((struct fixture *)context)->lost, true); }

static int set_up(void **state)
{
    struct error err = {0};
    struct fixture *f = calloc(1, sizeof *f);
    memset(&fake, 0, sizeof fake);
    f->pool = job_pool_create(1, &err);
    f->encoders = encode_pool_create(2, on_done, f, &err);
    struct render_loop_options options = {
        .renderer.threads = 1, .pool = f->pool, .encoders = f->encoders, .metrics = &f->metrics, .lost = on_lost, .context = f};
    f->loop = render_loop_create(&options, &err);
    f->scene.scene = scene_load("builtin:box", &err);
    f->scene.status = SCENE_READY;
    assert_non_null(f->loop);
    assert_non_null(f->scene.scene);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    render_loop_stop(f->loop, &f->scene);
    for (uint32_t view = 1; view <= RENDER_LOOP_VIEWS + 1; view++)
        render_loop_close(f->loop, view);
    encode_pool_stop(f->encoders);
    struct encode_job *lists[] = {f->jobs, encode_pool_take(f->encoders)};
    for (size_t i = 0; i < 2; i++)
        for (struct encode_job *job = lists[i], *next; job; job = next) {
            next = job->link;
            if (job->request) {
                render_request_destroy(job->request);
                job->request = NULL;
            }
            encode_job_destroy(job);
        }
    render_loop_destroy(f->loop);
    encode_pool_destroy(f->encoders);
    job_pool_destroy(f->pool);
    assert_int_equal(f->scene.refs, 0);
    scene_destroy(f->scene.scene);
    free(f);
    return 0;
}

static struct view_state state_of(struct fixture *f, uint32_t seq)
{
    struct view_state s = {
        .settings = render_settings_default(f->scene.scene), .quality = 75, .input_seq = seq, .input_time_us = seq * 1000ull};
    s.settings.camera.eye.x = seq;
    return s;
}

/* The next finished job, or NULL after `ms`. The caller destroys it. */
static struct encode_job *next_job(struct fixture *f, unsigned ms)
{
    for (unsigned waited = 0; !f->jobs && waited <= ms; waited++) {
        f->jobs = encode_pool_take(f->encoders);
        if (!f->jobs)
            usleep(1000);
    }
    struct encode_job *job = f->jobs;
    if (job) {
        f->jobs = job->link;
        job->link = NULL;
    }
    return job;
}

static struct frame_header take_frame(struct fixture *f)
{
    struct encode_job *job = next_job(f, PATIENCE_MS);
    assert_non_null(job);
    assert_int_equal(job->err.code, ERROR_NONE);
    struct frame_header header = job->header;
    render_loop_sent(f->loop, header.view, header.frame, header.encode_us, job->packet->size);
    encode_job_destroy(job);
    return header;
}

static void assert_quiet(struct fixture *f) { assert_null(next_job(f, QUIET_MS)); }

static void open_view(struct fixture *f, uint32_t view, uint64_t session)
{
    struct view_state s = state_of(f, 1);
    assert_true(render_loop_open(f->loop, view, session, &f->scene, &s));
}

static void test_frame_then_still_then_rest(void **state)
{
    struct fixture *f = *state;
    open_view(f, 1, 10);
    struct frame_header header = take_frame(f);
    assert_int_equal(header.frame, 1);
    assert_int_equal(header.input_seq, 1);
    assert_int_equal(header.input_time_us, 1000);
    assert_int_equal(header.flags & GNMF_STILL, 0);
    assert_int_equal(header.width, 64);
    assert_true(render_loop_ack(f->loop, 1, 1));
    header = take_frame(f);
    assert_int_equal(header.flags & GNMF_STILL, GNMF_STILL);
    assert_true(render_loop_ack(f->loop, 1, 2));
    assert_quiet(f);
    assert_int_equal(fake.submitted, 2);
}

static void test_newest_state_wins(void **state)
{
    struct fixture *f = *state;
    atomic_store(&fake.delay_us, 20000);
    open_view(f, 1, 10);
    for (uint32_t seq = 2; seq <= 200; seq++) {
        struct view_state s = state_of(f, seq);
        render_loop_update(f->loop, 1, &s);
    }
    uint32_t last = 0;
    while (last != 200) {
        struct frame_header header = take_frame(f);
        assert_true(header.input_seq > last);
        last = header.input_seq;
        assert_true(render_loop_ack(f->loop, 1, header.frame));
    }
    assert_true(fake.submitted < 10);
    assert_true(f->metrics.dropped[DROP_BUSY] + f->metrics.dropped[DROP_CREDIT] >= 190);
}

static void test_without_credit_nothing_is_rendered(void **state)
{
    struct fixture *f = *state;
    open_view(f, 1, 10);
    take_frame(f);
    struct view_state s = state_of(f, 2);
    render_loop_update(f->loop, 1, &s);
    take_frame(f);
    for (uint32_t seq = 3; seq < 50; seq++) {
        s = state_of(f, seq);
        render_loop_update(f->loop, 1, &s);
    }
    assert_quiet(f);
    assert_int_equal(fake.submitted, STREAM_IN_FLIGHT);
    assert_true(render_loop_ack(f->loop, 1, 2));
    assert_int_equal(take_frame(f).input_seq, 49);
}

static void test_blocked_session_costs_nothing(void **state)
{
    struct fixture *f = *state;
    open_view(f, 1, 10);
    open_view(f, 2, 20);
    take_frame(f), take_frame(f);
    render_loop_blocked(f->loop, 10, true);
    for (uint32_t view = 1; view <= 2; view++) {
        struct view_state s = state_of(f, 2);
        render_loop_update(f->loop, view, &s);
    }
    assert_int_equal(take_frame(f).view, 2);
    assert_quiet(f);
    render_loop_blocked(f->loop, 10, false);
    assert_int_equal(take_frame(f).view, 1);
}

static struct render_request *make_snapshot(struct fixture *f, uint32_t id)
{
    struct render_request *snapshot = render_request_create(&f->scene);
    snapshot->settings = render_settings_default(f->scene.scene);
    snapshot->codec = GNMF_JPEG;
    snapshot->quality = 80;
    snapshot->request_id = id;
    return snapshot;
}

static void finish_snapshot(struct encode_job *job)
{
    render_request_destroy(job->request);
    job->request = NULL;
    encode_job_destroy(job);
}

static void test_snapshots_come_in_order_and_are_bounded(void **state)
{
    struct fixture *f = *state;
    atomic_store(&fake.delay_us, 2000);
    uint32_t taken = 0;
    struct render_request *refused = NULL;
    for (uint32_t id = 1; id <= 200 && !refused; id++) {
        struct render_request *snapshot = make_snapshot(f, id);
        if (render_loop_request(f->loop, snapshot))
            taken++;
        else
            refused = snapshot;
    }
    assert_non_null(refused);
    render_request_destroy(refused);
    for (uint32_t i = 0; i < taken; i++) {
        struct encode_job *job = next_job(f, PATIENCE_MS);
        assert_non_null(job);
        assert_non_null(job->packet);
        assert_int_equal(job->header.kind, GNMF_SNAPSHOT);
        finish_snapshot(job);
    }
}

/* A progressive system's picture is rendered until nothing changes any more. */
static void test_snapshots_are_refined(void **state)
{
    struct fixture *f = *state;
    atomic_store(&fake.rounds, 5);
    assert_true(render_loop_request(f->loop, make_snapshot(f, 1)));
    struct encode_job *job = next_job(f, PATIENCE_MS);
    assert_non_null(job);
    assert_non_null(job->packet);
    assert_int_equal(atomic_load(&fake.submitted), 5);
    finish_snapshot(job);
    assert_null(next_job(f, QUIET_MS));
}

static void test_late_and_cancelled_snapshots_are_not_rendered(void **state)
{
    struct fixture *f = *state;
    struct render_request *late = make_snapshot(f, 1), *cancelled = make_snapshot(f, 2);
    late->deadline_us = 1;
    atomic_store(&cancelled->cancelled, true);
    assert_true(render_loop_request(f->loop, late));
    assert_true(render_loop_request(f->loop, cancelled));
    for (int i = 0; i < 2; i++) {
        struct encode_job *job = next_job(f, PATIENCE_MS);
        assert_non_null(job);
        assert_int_equal(job->err.code, ERROR_TRY_AGAIN);
        assert_null(job->packet);
        finish_snapshot(job);
    }
    assert_int_equal(fake.submitted, 0);
}

static void test_failed_frame_is_told_once(void **state)
{
    struct fixture *f = *state;
    atomic_store(&fake.fail_submit, true);
    open_view(f, 1, 10);
    struct encode_job *job = next_job(f, PATIENCE_MS);
    assert_non_null(job);
    assert_int_equal(job->err.code, ERROR_BUG);
    assert_int_equal(job->header.view, 1);
    render_loop_lost(f->loop, 1, job->header.frame);
    encode_job_destroy(job);
    assert_int_equal(f->metrics.dropped[DROP_FAILED], 1);
    /* The next state is tried afresh. */
    atomic_store(&fake.fail_submit, false);
    struct view_state s = state_of(f, 2);
    render_loop_update(f->loop, 1, &s);
    assert_int_equal(take_frame(f).input_seq, 2);
}

static void test_device_lost(void **state)
{
    struct fixture *f = *state;
    atomic_store(&fake.delay_us, 5000);
    open_view(f, 1, 10);
    atomic_store(&fake.lose, true);
    struct encode_job *job = next_job(f, PATIENCE_MS);
    assert_non_null(job);
    assert_int_equal(job->err.code, ERROR_TRY_AGAIN);
    encode_job_destroy(job);
    for (int i = 0; i < 1000 && !atomic_load(&f->lost); i++)
        usleep(1000);
    assert_true(atomic_load(&f->lost));
}

static void test_views_are_bounded(void **state)
{
    struct fixture *f = *state;
    struct view_state s = state_of(f, 1);
    s.paused = true;
    for (uint32_t view = 1; view <= RENDER_LOOP_VIEWS; view++)
        assert_true(render_loop_open(f->loop, view, 10, &f->scene, &s));
    assert_false(render_loop_open(f->loop, RENDER_LOOP_VIEWS + 1, 10, &f->scene, &s));
    render_loop_close(f->loop, 5);
    assert_true(render_loop_open(f->loop, RENDER_LOOP_VIEWS + 1, 10, &f->scene, &s));
    assert_quiet(f);
}

static void test_no_device(void **state)
{
    (void)state;
    struct error err = {0};
    struct metrics metrics = {0};
    struct fixture context = {0};
    struct encode_pool *encoders = encode_pool_create(1, on_done, &context, &err);
    struct render_loop_options options = {
        .renderer = {.device = "none", .threads = 1}, .encoders = encoders, .metrics = &metrics};
    assert_null(render_loop_create(&options, &err));
    assert_int_equal(err.code, ERROR_NO_DEVICE);
    encode_pool_destroy(encoders);
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(test_frame_then_still_then_rest),
        CASE(test_newest_state_wins),
        CASE(test_without_credit_nothing_is_rendered),
        CASE(test_blocked_session_costs_nothing),
        CASE(test_snapshots_come_in_order_and_are_bounded),
        CASE(test_snapshots_are_refined),
        CASE(test_late_and_cancelled_snapshots_are_not_rendered),
        CASE(test_failed_frame_is_told_once),
        CASE(test_device_lost),
        CASE(test_views_are_bounded),
        cmocka_unit_test(test_no_device),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
