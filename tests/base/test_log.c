#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/log.h"

/* Standard error in a file while a test runs. */
struct capture {
    int file, saved;
};

static struct capture capture_start(void)
{
    char name[] = "/tmp/gnomon-log-XXXXXX";
    struct capture c = {.file = mkstemp(name), .saved = dup(STDERR_FILENO)};
    assert_true(c.file >= 0 && c.saved >= 0);
    unlink(name);
    assert_true(fcntl(c.file, F_SETFL, O_APPEND) == 0);
    assert_true(dup2(c.file, STDERR_FILENO) >= 0);
    return c;
}

/* What was written; the caller frees. */
static char *capture_stop(struct capture *c)
{
    dup2(c->saved, STDERR_FILENO);
    close(c->saved);
    off_t size = lseek(c->file, 0, SEEK_END);
    char *text = calloc(1, (size_t)size + 1);
    assert_non_null(text);
    assert_int_equal(pread(c->file, text, (size_t)size, 0), size);
    close(c->file);
    return text;
}

static int restore_level(void **state)
{
    (void)state;
    log_set_level(LOG_WARNING);
    return 0;
}

static void lines_are_marked(void **state)
{
    (void)state;
    struct capture c = capture_start();
    log_warning("disk %d%% full", 93);
    log_error("gone");
    char *text = capture_stop(&c);
    assert_string_equal(text, "gnomon: warning: disk 93% full\ngnomon: error: gone\n");
    free(text);
}

static void level_filters(void **state)
{
    (void)state;
    assert_int_equal(log_get_level(), LOG_WARNING);
    struct capture c = capture_start();
    log_info("unseen");
    log_set_level(LOG_INFO);
    log_info("seen");
    log_debug("unseen");
    log_set_level(LOG_ERROR);
    log_warning("unseen");
    char *text = capture_stop(&c);
    assert_string_equal(text, "gnomon: info: seen\n");
    free(text);
}

static void long_lines_are_cut(void **state)
{
    (void)state;
    char big[5000];
    memset(big, 'b', sizeof big - 1);
    big[sizeof big - 1] = 0;
    struct capture c = capture_start();
    log_error("%s", big);
    char *text = capture_stop(&c);
    size_t length = strlen(text);
    assert_true(length > 1000 && length < 2100);
    assert_int_equal(text[length - 1], '\n');
    assert_int_equal(text[length - 2], 'b');
    free(text);
}

#define THREADS 4
#define LINES   500

static void *write_lines(void *argument)
{
    char letter = *(char *)argument, line[65];
    memset(line, letter, 64);
    line[64] = 0;
    for (int i = 0; i < LINES; i++)
        log_error("%s", line);
    return NULL;
}

static void threads_do_not_mix_lines(void **state)
{
    (void)state;
    pthread_t threads[THREADS];
    char letters[] = "abcd";
    struct capture c = capture_start();
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, write_lines, &letters[i]), 0);
    for (int i = 0; i < THREADS; i++)
        pthread_join(threads[i], NULL);
    char *text = capture_stop(&c);
    int count = 0;
    for (char *save, *line = strtok_r(text, "\n", &save); line; line = strtok_r(NULL, "\n", &save), count++) {
        const char *body = line + strlen("gnomon: error: ");
        assert_int_equal(strlen(body), 64);
        assert_int_equal(strspn(body, (char[]){body[0], 0}), 64);
    }
    assert_int_equal(count, THREADS * LINES);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(lines_are_marked, restore_level),
        cmocka_unit_test_teardown(level_filters, restore_level),
        cmocka_unit_test_teardown(long_lines_are_cut, restore_level),
        cmocka_unit_test_teardown(threads_do_not_mix_lines, restore_level),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
