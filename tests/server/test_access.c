#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "access.h"
#include "base/error.h"

static bool read_text(struct access *access, const char *text, struct error *err)
{
    char path[] = "/tmp/gnomon-tokens-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text));
    close(fd);
    bool ok = access_read_tokens(access, path, err);
    unlink(path);
    return ok;
}

static void test_tokens(void **state)
{
    (void)state;
    struct access access = {0};
    struct error err = {0};
    assert_int_equal(access_role(&access, NULL), ROLE_CONTROL);
    assert_true(read_text(&access, "# comment\n\nview looker\r\n  control\tdriver\nview driver\n", &err));
    assert_int_equal(access_role(&access, "looker"), ROLE_VIEW);
    assert_int_equal(access_role(&access, "driver"), ROLE_CONTROL);
    assert_int_equal(access_role(&access, "drive"), ROLE_NONE);
    assert_int_equal(access_role(&access, ""), ROLE_NONE);
    assert_int_equal(access_role(&access, NULL), ROLE_NONE);
    access_finish(&access);
}

static void test_bad_token_files(void **state)
{
    (void)state;
    static const char *const texts[] = {"", "# none\n", "view\n", "admin token\n", "view a b\n"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct access access = {0};
        struct error err = {0};
        assert_false(read_text(&access, texts[i], &err));
        assert_int_equal(err.code, ERROR_USAGE);
        access_finish(&access);
    }
    struct access access = {0};
    struct error err = {0};
    assert_false(access_read_tokens(&access, "/nonesuch", &err));
    assert_int_equal(err.code, ERROR_NO_INPUT);
}

static void test_hosts(void **state)
{
    (void)state;
    static const char *const origins[] = {"https://pages.example"};
    struct access local = {.listen_host = "127.0.0.1", .loopback = true};
    struct access network = {.listen_host = "0.0.0.0", .origins = origins, .origin_count = 1};
    static const char *const good[] = {"127.0.0.1", "127.0.0.1:8080", "localhost", "LOCALHOST:1", "[::1]", "[::1]:80"};
    static const char *const foreign[] = {
        "evil.example", "evil.example:8080", "127.0.0.1.evil.example", "localhost.evil", "", ":80", "[::1",
        "[::1]x",       "localhost:8o",      "localhost/@evil"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        assert_true(access_host_ok(&local, good[i]));
    for (size_t i = 0; i < sizeof foreign / sizeof foreign[0]; i++) {
        assert_false(access_host_ok(&local, foreign[i]));
        assert_false(access_host_ok(&network, foreign[i]));
    }
    assert_false(access_host_ok(&local, NULL));
    assert_false(access_host_ok(&local, "192.168.1.7:8080"));
    assert_true(access_host_ok(&network, "192.168.1.7:8080"));
    assert_true(access_host_ok(&network, "pages.example"));
}

static void test_origins(void **state)
{
    (void)state;
    static const char *const origins[] = {"https://pages.example"};
    struct access access = {.listen_host = "127.0.0.1", .loopback = true, .origins = origins, .origin_count = 1};
    assert_true(access_origin_ok(&access, NULL, "127.0.0.1:80"));
    assert_true(access_origin_ok(&access, "http://127.0.0.1:80", "127.0.0.1:80"));
    assert_true(access_origin_ok(&access, "https://pages.example", "127.0.0.1:80"));
    assert_false(access_origin_ok(&access, "http://127.0.0.1:81", "127.0.0.1:80"));
    assert_false(access_origin_ok(&access, "http://pages.example", "127.0.0.1:80"));
    assert_false(access_origin_ok(&access, "https://pages.example.evil", "127.0.0.1:80"));
    assert_false(access_origin_ok(&access, "null", "127.0.0.1:80"));
    assert_false(access_origin_ok(&access, "", "127.0.0.1:80"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tokens),
        cmocka_unit_test(test_bad_token_files),
        cmocka_unit_test(test_hosts),
        cmocka_unit_test(test_origins),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
