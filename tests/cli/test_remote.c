/* --server: the same pictures and lists as without it, and what is said when the other side is none, is busy, or breaks off. The server runs in
 * this process; those that misbehave are a socket with one answer. */
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
#include <unistd.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "command.h"
#include "import/import.h"
#include "server.h"

#define WORDS 24

struct fixture {
    char folder[64], url[64], tokens[96];
    struct job_pool *pool;
    struct common_options common;
    struct server server;
    pthread_t thread;
    char said[4096]; /* on standard error, by the last command */
};

static struct fixture f;

static void *net_main(void *argument)
{
    net_run(argument);
    return NULL;
}

static int set_up(void **state)
{
    struct error err = {0};
    (void)state;
    strcpy(f.folder, "/tmp/gnomon-remote-XXXXXX");
    assert_non_null(mkdtemp(f.folder));
    snprintf(f.tokens, sizeof f.tokens, "%s/tokens", f.folder);
    FILE *tokens = fopen(f.tokens, "w");
    assert_non_null(tokens);
    fputs("# who may look\nview looker\n", tokens);
    fclose(tokens);
    common_options_init(&f.common);
    f.common.threads = 2;
    f.common.width = 96;
    f.common.height = 64;
    f.pool = job_pool_create(f.common.threads, &err);
    struct server_options options = {.host = "127.0.0.1", .token_file = f.tokens, .common = &f.common, .pool = f.pool};
    if (!server_init(&f.server, &options, &err)) {
        fprintf(stderr, "%s\n", err.message);
        exit(err.code == ERROR_NO_DEVICE ? 77 : 1);
    }
    assert_true(server_load_first(&f.server, &err));
    assert_int_equal(pthread_create(&f.thread, NULL, net_main, f.server.net), 0);
    snprintf(f.url, sizeof f.url, "http://127.0.0.1:%u/", net_port(f.server.net));
    return 0;
}

static int tear_down(void **state)
{
    char command[128];
    (void)state;
    net_stop(f.server.net);
    pthread_join(f.thread, NULL);
    server_finish(&f.server);
    job_pool_destroy(f.pool);
    snprintf(command, sizeof command, "rm -r %s", f.folder);
    return system(command);
}

/* A command in this process, its standard error into f.said. */
static int run(int (*command)(int, char **), const char *const *words)
{
    char *argv[WORDS + 1] = {0};
    int argc = 0;
    for (; words[argc]; argc++) {
        assert_true(argc < WORDS);
        argv[argc] = (char *)words[argc];
    }
    FILE *kept = tmpfile();
    int terminal = dup(STDERR_FILENO);
    fflush(stderr);
    dup2(fileno(kept), STDERR_FILENO);
    int code = command(argc, argv);
    fflush(stderr);
    dup2(terminal, STDERR_FILENO);
    close(terminal);
    rewind(kept);
    f.said[fread(f.said, 1, sizeof f.said - 1, kept)] = 0;
    fclose(kept);
    return code;
}

static uint8_t *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    uint8_t *data = malloc(*size);
    assert_int_equal(fread(data, 1, *size, file), *size);
    fclose(file);
    return data;
}

/* Where the chunks of a scan line OpenEXR begin: past the attributes comes a table of their places. */
static size_t exr_chunks(const uint8_t *data, size_t size)
{
    size_t at = 8;
    while (at < size && data[at]) {
        at += strlen((const char *)data + at) + 1;
        at += strlen((const char *)data + at) + 1;
        uint32_t bytes;
        memcpy(&bytes, data + at, 4);
        at += 4 + bytes;
    }
    uint64_t first;
    memcpy(&first, data + at + 1, 8);
    assert_true(first < size);
    return first;
}

static void assert_same_picture(const char *a_path, const char *b_path, bool exr, bool same)
{
    struct error err = {0};
    size_t a_size, b_size;
    uint8_t *a = read_file(a_path, &a_size), *b = read_file(b_path, &b_size);
    bool equal;
    if (exr) {
        size_t a_at = exr_chunks(a, a_size), b_at = exr_chunks(b, b_size);
        equal = a_size - a_at == b_size - b_at && memcmp(a + a_at, b + b_at, a_size - a_at) == 0;
    } else {
        struct image x, y;
        assert_true(image_decode(a, a_size, "a", &x, &err));
        assert_true(image_decode(b, b_size, "b", &y, &err));
        assert_int_equal(x.width, 96);
        equal = x.width == y.width && x.height == y.height && memcmp(x.rgba, y.rgba, (size_t)x.width * x.height * 4) == 0;
        free(x.rgba);
        free(y.rgba);
    }
    assert_int_equal(equal, same);
    free(a);
    free(b);
}

/* Renders twice, here and there; returns the paths' common part. */
static void render_both(const char *extension, const char *const *options, char here[128], char there[128])
{
    const char *words[WORDS + 1] = {"render", "builtin:box", "--size", "96x64", "--threads", "2", "-o", here};
    size_t n = 8;
    snprintf(here, 128, "%s/here.%s", f.folder, extension);
    snprintf(there, 128, "%s/there.%s", f.folder, extension);
    for (size_t i = 0; options[i]; i++)
        words[n++] = options[i];
    if (run(command_render, words) != 0)
        fail_msg("%s", f.said);
    words[4] = "--server";
    words[5] = f.url;
    words[7] = there;
    words[n++] = "--token-file";
    words[n++] = f.tokens;
    words[n] = NULL;
    if (run(command_render, words) != 0)
        fail_msg("%s", f.said);
    assert_string_equal(f.said, "");
}

static void test_same_pictures(void **state)
{
    static const char *const options[][10] = {
        {NULL},
        {"--camera", "auto"},
        {"--eye", "4.1,3.3,-2.7", "--target", "0.1,0.2,0.3", "--up", "0.1,1,0.2", "--fov", "33.3"},
        {"--eye", "4,3,5", "--target", "0,0.5,0", "--ortho", "3.7"},
        {"--light", "spot position=2,4.2,1 direction=-2,-4.2,-1.1 color=1,0.9,0.7 intensity=510.5 inner=10.1 outer=31.7 range=30",
         "--light", "directional direction=-1,-3,0.7 intensity=1.1", "--light", "point position=-3,3,2 intensity=40 radius=0.1"},
        {"--algorithm", "sm:size=64,slope=1"},
        {"--algorithm", "none"},
        {"--show", "visibility"},
        {"--show", "normal"},
        {"--show", "depth"},
        {"--show", "id"},
        {"--exposure", "1.3", "--ambient", "0.11"},
        {"--tonemap", "none", "--aa", "4"},
        {"--camera-pass", "raster"},
        {"--camera-pass", "traced"},
    };
    char here[128], there[128];
    (void)state;
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        render_both("png", options[i], here, there);
        assert_same_picture(here, there, false, true);
    }
    /* And the comparison can fail. */
    char other[128];
    snprintf(other, sizeof other, "%s/kept.png", f.folder);
    assert_int_equal(rename(there, other), 0);
    render_both("png", options[4], here, there);
    assert_same_picture(here, other, false, false);
}

static void test_same_formats(void **state)
{
    static const char *const formats[] = {"jpg", "webp", "exr"};
    static const char *const options[] = {"--aa", "4", NULL};
    char here[128], there[128];
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        render_both(formats[i], options, here, there);
        assert_same_picture(here, there, i == 2, true);
    }
}

static json_t *list(const char *what, const char *server)
{
    char path[128];
    snprintf(path, sizeof path, "%s/list.json", f.folder);
    const char *words[] = {"list", what, "--json", path, server ? "--server" : NULL, server, "--token-file", f.tokens, NULL};
    if (run(command_list, words) != 0)
        fail_msg("%s", f.said);
    json_t *root = json_load_file(path, 0, NULL), *listing = json_incref(json_object_get(root, what));
    assert_true(json_is_array(listing) && json_array_size(listing) > 0);
    json_decref(root);
    return listing;
}

static void test_lists(void **state)
{
    (void)state;
    setenv("GNOMON_TOKEN", "looker", 1);
    json_t *here = list("algorithms", NULL), *there = list("algorithms", f.url);
    assert_true(json_equal(here, there));
    json_decref(here);
    json_decref(there);
    there = list("scenes", f.url);
    assert_non_null(json_object_get(json_array_get(there, 0), "name"));
    json_decref(there);
    there = list("devices", f.url);
    assert_int_equal(json_array_size(there), 1);
    assert_true(json_is_true(json_object_get(json_array_get(there, 0), "usable")));
    json_decref(there);
    const char *bare[] = {"list", "devices", "--server", f.url, NULL};
    assert_int_equal(run(command_list, bare), 0); /* the token comes from the environment */
    unsetenv("GNOMON_TOKEN");
    assert_int_equal(run(command_list, bare), ERROR_USAGE);
    assert_non_null(strstr(f.said, "token"));
}

/* One line, that exit code, and what it must name. */
static void refused(const char *const *words, enum error_code code, const char *wanted)
{
    int got = run(command_render, words);
    size_t length = strlen(f.said);
    if (got != (int)code || !strstr(f.said, wanted) || strncmp(f.said, "gnomon: error: ", 15) != 0 || length == 0 ||
        strchr(f.said, '\n') != f.said + length - 1)
        fail_msg("%d, not %d with '%s': %s", got, (int)code, wanted, f.said);
}

static void test_refusals(void **state)
{
    char out[128];
    (void)state;
    snprintf(out, sizeof out, "%s/refused.png", f.folder);
    const struct {
        const char *scene, *option, *value;
        enum error_code code;
        const char *wanted;
    } cases[] = {
        {"builtin:box", "--threads", "2", ERROR_USAGE, "--threads cannot be sent"},
        {"builtin:box", "--device", "software", ERROR_USAGE, "--device cannot be sent"},
        {"builtin:box", "--frames-timed", "3", ERROR_USAGE, "--frames-timed cannot be sent"},
        {"builtin:box", "--stats", "-", ERROR_USAGE, "--stats and --server"},
        {"builtin:box", "--camera", "nobody", ERROR_USAGE, "nobody"},
        {"builtin:box", "--camera", "\xff", ERROR_USAGE, "UTF-8"},
        {"builtin:nonesuch", "--aa", "1", ERROR_NO_INPUT, "nonesuch"},
        {"/etc/passwd", "--aa", "1", ERROR_NO_INPUT, "passwd"},
        {"builtin:box", "--server", "ftp://127.0.0.1/", ERROR_USAGE, "http://HOST:PORT/"},
        {"builtin:box", "--server", "http://127.0.0.1:1/?token=a", ERROR_USAGE, "GNOMON_TOKEN"},
        {"builtin:box", "--token-file", "/no/such/file", ERROR_NO_INPUT, "/no/such/file"},
        {"builtin:box", "--token-file", "/dev/null", ERROR_USAGE, "no token"},
        {"builtin:box", "--server", "http://127.0.0.1:1", ERROR_IO, "no answer from http://127.0.0.1:1"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *words[] = {"render", cases[i].scene,  "-o",           out, "--server", f.url, "--token-file",
                               f.tokens, cases[i].option, cases[i].value, NULL};
        refused(words, cases[i].code, cases[i].wanted);
    }
    const char *other_name[] = {"render", "builtin:box", "-o", out, "--server", f.url, NULL};
    refused(other_name, ERROR_USAGE, "token");
    assert_int_not_equal(access(out, F_OK), 0);
}

/* A server that says one thing and hangs up. */
struct one_answer {
    int listener;
    const char *text;
};

static void *answer_main(void *argument)
{
    const struct one_answer *a = argument;
    char request[4096];
    int s = accept(a->listener, NULL, NULL);
    assert_true(recv(s, request, sizeof request, 0) > 0);
    assert_int_equal(send(s, a->text, strlen(a->text), MSG_NOSIGNAL), (ssize_t)strlen(a->text));
    shutdown(s, SHUT_WR);
    while (recv(s, request, sizeof request, 0) > 0)
        ;
    close(s);
    return NULL;
}

static void answered(const char *text, enum error_code code, const char *wanted)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof address;
    struct one_answer a = {.listener = socket(AF_INET, SOCK_STREAM, 0), .text = text};
    assert_int_equal(bind(a.listener, (struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(listen(a.listener, 1), 0);
    assert_int_equal(getsockname(a.listener, (struct sockaddr *)&address, &size), 0);
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, answer_main, &a), 0);
    char url[64], out[128];
    snprintf(url, sizeof url, "http://127.0.0.1:%u", ntohs(address.sin_port));
    snprintf(out, sizeof out, "%s/answered.png", f.folder);
    const char *words[] = {"render", "builtin:box", "-o", out, "--server", url, NULL};
    refused(words, code, wanted);
    assert_int_not_equal(access(out, F_OK), 0);
    pthread_join(thread, NULL);
    close(a.listener);
}

static void test_bad_servers(void **state)
{
    (void)state;
    answered("hello\r\n", ERROR_IO, "no answer from");
    answered("", ERROR_IO, "no answer from");
    answered("HTTP/1.1 200 OK\r\nContent-Type: image/png\r\nContent-Length: 5\r\n\r\nhello", ERROR_IO, "no picture");
    answered("HTTP/1.1 200 OK\r\nContent-Type: image/png\r\nContent-Length: 5000\r\n\r\n\x89PNG", ERROR_IO, "early");
    answered("HTTP/1.1 302 Found\r\nLocation: /\r\nContent-Length: 0\r\n\r\n", ERROR_IO, "302");
    answered("HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\n\r\n", ERROR_USAGE, "name");
    answered("HTTP/1.1 404 Not Found\r\nContent-Length: 4\r\n\r\nnone", ERROR_IO, "404");
    answered("HTTP/1.1 503 Busy\r\nContent-Length: 0\r\n\r\n", ERROR_TRY_AGAIN, "try again");
#define JSON_ANSWER(status, body) "HTTP/1.1 " status "\r\nContent-Type: application/json\r\nConnection: close\r\n\r\n" body
    answered(JSON_ANSWER("503 Busy", "{\"error\":{\"code\":-32004,\"message\":\"16 wait\"}}"), ERROR_TRY_AGAIN, "16 wait");
    answered(JSON_ANSWER("422 Bad", "{\"error\":{\"code\":-32001,\"message\":\"a bad scene\"}}"), ERROR_DATA, "a bad scene");
    answered(JSON_ANSWER("500 Oh", "{\"error\":[\"what\"]}"), ERROR_IO, "500");
    answered(JSON_ANSWER("500 Oh", "{\"error\":"), ERROR_IO, "500");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_pictures), cmocka_unit_test(test_same_formats),
                                       cmocka_unit_test(test_lists), cmocka_unit_test(test_refusals),
                                       cmocka_unit_test(test_bad_servers)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
