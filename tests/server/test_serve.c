/* The whole server in this process, over a renderer without GL, with clients on real sockets: what the thread sanitizer watches. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <arpa/inet.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/job_pool.h"
#include "fake_renderer.h"
#include "server.h"

#define CLIENTS 4
#define ROUNDS  25

struct fixture {
    struct job_pool *pool;
    struct common_options common;
    struct server server;
    pthread_t thread;
};

static void *net_main(void *argument)
{
    net_run(argument);
    return NULL;
}

static int set_up(void **state)
{
    struct error err = {0};
    struct fixture *f = calloc(1, sizeof *f);
    memset(&fake, 0, sizeof fake);
    common_options_init(&f->common);
    f->common.threads = 4;
    f->common.width = 64;
    f->common.height = 48;
    f->pool = job_pool_create(1, &err);
    struct server_options options = {.host = "127.0.0.1", .common = &f->common, .pool = f->pool};
    assert_true(server_init(&f->server, &options, &err));
    assert_true(server_load_first(&f->server, &err));
    assert_int_equal(pthread_create(&f->thread, NULL, net_main, f->server.net), 0);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    net_stop(f->server.net);
    pthread_join(f->thread, NULL);
    server_finish(&f->server);
    job_pool_destroy(f->pool);
    free(f);
    return 0;
}

static int dial(const struct fixture *f)
{
    struct sockaddr_in address = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)net_port(f->server.net)), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    struct timeval patience = {.tv_sec = 30};
    int s = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(connect(s, (struct sockaddr *)&address, sizeof address), 0);
    setsockopt(s, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    return s;
}

static void put(int s, const void *data, size_t size) { assert_int_equal(send(s, data, size, MSG_NOSIGNAL), (ssize_t)size); }

static void get(int s, void *data, size_t size) { assert_int_equal(recv(s, data, size, MSG_WAITALL), (ssize_t)size); }

static int ws_open(const struct fixture *f)
{
    static const char request[] =
        "GET /ws HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: " SERVER_SUBPROTOCOL "\r\n\r\n";
    char answer[2048] = "";
    int s = dial(f);
    put(s, request, sizeof request - 1);
    for (size_t n = 0; !strstr(answer, "\r\n\r\n"); n++) {
        assert_true(n < sizeof answer - 1);
        get(s, answer + n, 1);
    }
    assert_memory_equal(answer, "HTTP/1.1 101", 12);
    return s;
}

/* RFC 6455, 5.2; a mask of zeros leaves the text as it is. */
static void ws_put(int s, const char *text)
{
    size_t size = strlen(text);
    uint8_t frame[1024] = {0x81, 0x80 | 126, (uint8_t)(size >> 8), (uint8_t)size};
    assert_true(size + 8 <= sizeof frame);
    memcpy(frame + 8, text, size);
    put(s, frame, size + 8);
}

/* One message, which the caller frees; text is ended by a zero byte. Pings are passed over. */
static uint8_t *ws_get(int s, size_t *size, bool *binary)
{
    for (;;) {
        uint8_t head[2], more[8];
        get(s, head, 2);
        uint64_t length = head[1] & 0x7f;
        size_t extra = length == 126 ? 2 : length == 127 ? 8 : 0;
        get(s, more, extra);
        if (extra)
            length = 0;
        for (size_t i = 0; i < extra; i++)
            length = length << 8 | more[i];
        uint8_t *data = malloc(length + 1);
        get(s, data, length);
        data[length] = 0;
        *size = length;
        *binary = (head[0] & 15) == 2;
        if ((head[0] & 15) <= 2)
            return data;
        free(data);
    }
}

static uint64_t little(const uint8_t *at, unsigned bytes)
{
    uint64_t value = 0;
    for (unsigned i = bytes; i-- > 0;)
        value = value << 8 | at[i];
    return value;
}

/* Reads until a frame of ours comes; acknowledges it. Returns its input_seq. */
static uint32_t ws_get_frame(int s, unsigned view)
{
    for (;;) {
        size_t size;
        bool binary;
        uint8_t *data = ws_get(s, &size, &binary);
        if (!binary) {
            free(data);
            continue;
        }
        assert_true(size > GNMF_HEADER_SIZE && little(data + GNMF_AT_VIEW, 4) == view);
        char ack[128];
        snprintf(ack, sizeof ack, "{\"jsonrpc\":\"2.0\",\"method\":\"frame.ack\",\"params\":{\"view\":%u,\"frame\":%llu}}", view,
                 (unsigned long long)little(data + GNMF_AT_FRAME, 8));
        ws_put(s, ack);
        uint32_t seq = (uint32_t)little(data + GNMF_AT_INPUT_SEQ, 4);
        free(data);
        return seq;
    }
}

static unsigned ws_open_view(int s)
{
    size_t size;
    bool binary;
    uint8_t *hello = ws_get(s, &size, &binary);
    assert_non_null(strstr((char *)hello, "\"server.hello\""));
    free(hello);
    ws_put(s, "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"view.open\",\"params\":{\"scene\":\"builtin:box\",\"input_seq\":1}}");
    uint8_t *answer = ws_get(s, &size, &binary);
    const char *at = strstr((char *)answer, "\"view\":");
    assert_non_null(at);
    unsigned view = (unsigned)strtoul(at + 7, NULL, 10);
    free(answer);
    return view;
}

static void *stream_client(void *argument)
{
    const struct fixture *f = argument;
    int s = ws_open(f);
    unsigned view = ws_open_view(s);
    for (unsigned i = 2; i < ROUNDS; i++) {
        char text[256];
        snprintf(
            text, sizeof text,
            "{\"jsonrpc\":\"2.0\",\"method\":\"view.set\",\"params\":{\"view\":%u,\"input_seq\":%u,\"camera\":{\"eye\":[%u,3,5],\"target\":[0,0,0]}}}",
            view, i, i);
        ws_put(s, text);
        while (ws_get_frame(s, view) < i)
            ;
    }
    close(s);
    return NULL;
}

/* Reads until the answer to request 2 comes, which holds `wanted`. */
static void ws_get_answer(int s, const char *wanted)
{
    for (;;) {
        size_t size;
        bool binary;
        uint8_t *data = ws_get(s, &size, &binary);
        bool ours = !binary && strstr((char *)data, "\"id\":2") && !strstr((char *)data, "$/progress");
        if (ours && !strstr((char *)data, wanted))
            fail_msg("%s", (char *)data);
        free(data);
        if (ours)
            return;
    }
}

/* Compares beside what the others do, and gives every second comparison up. */
static void *compare_client(void *argument)
{
    int s = ws_open(argument);
    unsigned view = ws_open_view(s);
    (void)view;
    for (int i = 0; i < ROUNDS; i++) {
        ws_put(
            s,
            "{\"jsonrpc\":\"2.0\",\"id\":2,\"method\":\"compare.run\",\"params\":{\"size\":[48,32],\"against\":\"samples32\",\"difference\":\"jpeg\"}}");
        if (i % 2)
            ws_put(s, "{\"jsonrpc\":\"2.0\",\"id\":3,\"method\":\"$/cancel\",\"params\":{\"id\":2}}");
        ws_get_answer(s, i % 2 ? "" : "\"receivers\":");
    }
    close(s);
    return NULL;
}

static void post(const struct fixture *f, const char *body, const char *wanted)
{
    char request[1024], answer[65536] = "";
    int s = dial(f);
    snprintf(request, sizeof request,
             "POST /v1/render HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Length: %zu\r\n\r\n%s", strlen(body),
             body);
    put(s, request, strlen(request));
    assert_true(recv(s, answer, sizeof answer - 1, 0) > 12);
    assert_memory_equal(answer, wanted, strlen(wanted));
    close(s);
}

static void *picture_client(void *argument)
{
    for (int i = 0; i < ROUNDS; i++) {
        post(argument, "{\"scene\":\"builtin:box\",\"size\":[32,16],\"format\":\"jpeg\"}", "HTTP/1.1 200");
        post(argument, "{\"scene\":\"builtin:box\",\"sighs\":[32,16]}", "HTTP/1.1 400");
    }
    return NULL;
}

/* Opens a view, asks for much, and goes without a word. */
static void *rude_client(void *argument)
{
    for (int i = 0; i < ROUNDS; i++) {
        int s = ws_open(argument);
        unsigned view = ws_open_view(s);
        char text[128];
        snprintf(text, sizeof text, "{\"jsonrpc\":\"2.0\",\"method\":\"view.set\",\"params\":{\"view\":%u,\"quality\":%d}}", view,
                 i + 1);
        ws_put(s, text);
        close(s);
    }
    return NULL;
}

static void test_many_clients(void **state)
{
    struct fixture *f = *state;
    void *(*const kinds[])(void *) = {stream_client, picture_client, rude_client};
    pthread_t threads[CLIENTS * 3 + 1];
    atomic_store(&fake.delay_us, 300);
    for (size_t i = 0; i < CLIENTS * 3; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, kinds[i % 3], f), 0);
    assert_int_equal(pthread_create(&threads[CLIENTS * 3], NULL, compare_client, f), 0);
    for (size_t i = 0; i < CLIENTS * 3 + 1; i++)
        pthread_join(threads[i], NULL);
    for (int i = 0; i < 5000 && atomic_load(&f->server.metrics.clients) > 0; i++)
        usleep(1000);
    assert_int_equal(atomic_load(&f->server.metrics.clients), 0);
    assert_int_equal(atomic_load(&f->server.metrics.views), 0);
    assert_true(atomic_load(&f->server.metrics.sent[GNMF_JPEG]) >= CLIENTS * (ROUNDS - 1));
}

#define STATES 60

static void set_eye(int s, unsigned view, unsigned seq)
{
    char text[256];
    snprintf(text, sizeof text,
             "{\"jsonrpc\":\"2.0\",\"method\":\"view.set\",\"params\":{\"view\":%u,\"input_seq\":%u,\"camera\":{\"eye\":[%u,3,5],"
             "\"target\":[0,0,0]}}}",
             view, seq, seq);
    ws_put(s, text);
}

/* A client that steers and does not read: no work is done for it, and when it reads again the newest state follows what had left before. */
static void test_client_that_does_not_read(void **state)
{
    struct fixture *f = *state;
    atomic_store(&fake.delay_us, 1000);
    int s = ws_open(f);
    unsigned view = ws_open_view(s);
    for (unsigned i = 2; i <= STATES; i++) {
        set_eye(s, view, i);
        usleep(5000);
    }
    assert_in_range(atomic_load(&fake.submitted), 1, STREAM_IN_FLIGHT);
    assert_in_range(ws_get_frame(s, view), 1, 2);
    assert_int_equal(ws_get_frame(s, view), STATES);
    assert_true(atomic_load(&f->server.metrics.dropped[DROP_CREDIT]) >= STATES - 4);
    close(s);
}

/* A thousand states a second from one client: none waits, the last is shown within two frames, and the other client has its share. */
static void test_flood_of_states(void **state)
{
    struct fixture *f = *state;
    atomic_store(&fake.delay_us, 4000);
    int flood = ws_open(f), other = ws_open(f);
    unsigned flooded = ws_open_view(flood), view = ws_open_view(other);
    unsigned sent = 1, shown = 0, frames = 0;
    struct timespec start, now;
    clock_gettime(CLOCK_MONOTONIC, &start);
    for (double elapsed = 0; elapsed < 1;
         elapsed = (double)(now.tv_sec - start.tv_sec) + 1e-9 * (double)(now.tv_nsec - start.tv_nsec)) {
        while (sent < 1100 * elapsed)
            set_eye(flood, flooded, ++sent);
        set_eye(other, view, ++shown + 1);
        while (ws_get_frame(other, view) < shown + 1)
            ;
        frames++;
        clock_gettime(CLOCK_MONOTONIC, &now);
    }
    set_eye(flood, flooded, ++sent);
    unsigned behind = 0, last = 0;
    while (last != sent) {
        last = ws_get_frame(flood, flooded);
        behind++;
    }
    assert_true(sent >= 500);
    /* It did not read meanwhile: what had left before, then the newest. */
    assert_in_range(behind, 1, 2);
    /* Frames of 4 ms, shared by two: more would be rendered than the half under load of the machine that runs the test. */
    assert_true(frames > 10);
    assert_true(atomic_load(&fake.submitted) < 2 * frames + 8);
    close(flood);
    close(other);
}

/* More scenes than are kept: the least used make room, on the device too. */
static void test_scenes_make_room(void **state)
{
    struct fixture *f = *state;
    for (int i = 0; i < SERVER_SCENES_MAX * 2; i++) {
        char body[128];
        snprintf(body, sizeof body, "{\"scene\":\"builtin:dragon:triangles=%d\",\"size\":[8,8]}", 1000 + i);
        post(f, body, "HTTP/1.1 200");
    }
    assert_true(atomic_load(&fake.scenes) <= SERVER_SCENES_MAX);
}

static void test_stop_with_work_under_way(void **state)
{
    struct fixture *f = *state;
    atomic_store(&fake.delay_us, 50000);
    int s = ws_open(f);
    unsigned view = ws_open_view(s);
    ws_put(s, "{\"jsonrpc\":\"2.0\",\"id\":2,\"method\":\"render.snapshot\",\"params\":{\"size\":[64,64]}}");
    ws_put(s, "{\"jsonrpc\":\"2.0\",\"id\":3,\"method\":\"view.open\",\"params\":{\"scene\":\"builtin:ball\"}}");
    (void)view;
    usleep(10000);
    close(s);
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {CASE(test_many_clients), CASE(test_client_that_does_not_read), CASE(test_flood_of_states),
                                       CASE(test_scenes_make_room), CASE(test_stop_with_work_under_way)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
