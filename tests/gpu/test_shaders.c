/* Shaders from a folder are reloaded when they change, a broken one leaves the old program at work; linked programs are
 * cached on disk. */
#include <dirent.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/log.h"
#include "studio.h"

/* A folder of our own, removed at the end of the test. */
struct folder {
    char path[256];
};

static struct folder folder_make(void)
{
    struct folder f;
    snprintf(f.path, sizeof f.path, "%s/shaders-XXXXXX", BINARY_DIR);
    assert_non_null(mkdtemp(f.path));
    return f;
}

static size_t list(const char *path, char names[][64], size_t max)
{
    size_t n = 0;
    DIR *dir = opendir(path);
    assert_non_null(dir);
    for (struct dirent *e; (e = readdir(dir));)
        if (e->d_name[0] != '.' && n < max)
            snprintf(names[n++], 64, "%.63s", e->d_name);
    closedir(dir);
    return n;
}

static void folder_remove(struct folder *f)
{
    char names[128][64], path[400];
    for (size_t n = list(f->path, names, 128); n-- > 0;) {
        snprintf(path, sizeof path, "%s/%s", f->path, names[n]);
        unlink(path);
    }
    assert_int_equal(rmdir(f->path), 0);
}

static char *read_text(const char *folder, const char *name)
{
    char path[400], *text = NULL;
    size_t size = 0;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    assert_true(getdelim(&text, &size, 0, f) > 0);
    fclose(f);
    return text;
}

/* Modification times must differ from the last write's whatever the file system's grain. */
static void write_text(const char *folder, const char *name, const char *text)
{
    static long stamp = 1000000000;
    char path[400];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_true(fputs(text, f) >= 0);
    assert_int_equal(fclose(f), 0);
    const struct timespec times[2] = {{time(NULL) + stamp, 0}, {time(NULL) + stamp, 0}};
    stamp += 10;
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
}

static void copy_shaders(const char *folder)
{
    char names[128][64];
    size_t n = list(SOURCE_DIR "/shaders", names, 128);
    assert_true(n > 10 && n < 128);
    while (n-- > 0) {
        char *text = read_text(SOURCE_DIR "/shaders", names[n]);
        write_text(folder, names[n], text);
        free(text);
    }
}

/* Longer than the renderer lets pass between two looks at the folder. */
static struct shot take_later(struct studio *studio, struct set *set)
{
    const struct timespec pause = {0, 300 * 1000 * 1000};
    nanosleep(&pause, NULL);
    return shot_take(studio, set);
}

static void test_hot_reload(void **state)
{
    (void)state;
    struct folder folder = folder_make();
    struct studio studio;
    copy_shaders(folder.path);
    assert_true(studio_open(&studio, folder.path, NULL));
    struct set set = set_load(&studio, "builtin:box");
    struct shot first = shot_take(&studio, &set);
    char *good = read_text(folder.path, "tonemap.glsl");

    write_text(folder.path, "tonemap.glsl", "this is no shader\n");
    enum log_level level = log_get_level();
    log_set_level(LOG_ERROR);
    struct shot broken = take_later(&studio, &set);
    log_set_level(level);
    assert_true(shot_same(&first, &broken));

    const char *head = "vec3 display_color(vec3 c)";
    char *changed = malloc(strlen(good) + 200), *at = strstr(good, head);
    assert_true(changed && at);
    sprintf(changed, "%.*svec3 display_color(vec3 c) { return c.bgr * 0.5; }\nvec3 unused_color(vec3 c)%s", (int)(at - good),
            good, at + strlen(head));
    write_text(folder.path, "tonemap.glsl", changed);
    struct shot mended = take_later(&studio, &set);
    assert_true(memcmp(first.pixels, mended.pixels, first.size) != 0);
    assert_memory_equal(first.ids, mended.ids, (size_t)first.width * first.height * sizeof *first.ids);

    write_text(folder.path, "tonemap.glsl", good);
    struct shot back = take_later(&studio, &set);
    assert_true(shot_same(&first, &back));

    free(changed);
    free(good);
    shot_drop(&first);
    shot_drop(&broken);
    shot_drop(&mended);
    shot_drop(&back);
    set_strike(&set);
    studio_close(&studio);
    folder_remove(&folder);
}

/* A shadow system's own shader: what was prepared with the old one is prepared anew. */
static void test_reload_prepares_anew(void **state)
{
    (void)state;
    struct folder folder = folder_make();
    struct studio studio;
    copy_shaders(folder.path);
    assert_true(studio_open(&studio, folder.path, NULL));
    struct set set = set_load(&studio, "builtin:box");
    struct shot first = shot_take(&studio, &set), second = take_later(&studio, &set);
    assert_true(first.info.prepared);
    assert_false(second.info.prepared);
    char *good = read_text(folder.path, "scene_draw.frag"), *again = malloc(strlen(good) + 32);
    assert_non_null(again);
    sprintf(again, "%s\n/* changed */\n", good);
    write_text(folder.path, "scene_draw.frag", again);
    struct shot third = take_later(&studio, &set);
    assert_true(third.info.prepared);
    assert_true(shot_same(&first, &third));
    free(again);
    free(good);
    shot_drop(&first);
    shot_drop(&second);
    shot_drop(&third);
    set_strike(&set);
    studio_close(&studio);
    folder_remove(&folder);
}

static void test_wrong_folders_are_told(void **state)
{
    (void)state;
    struct folder folder = folder_make();
    struct studio studio;
    struct error err = {0};
    assert_true(studio_open(&studio, NULL, NULL));
    struct renderer_options options = {.threads = 2, .shader_dir = "/nonexistent/shaders", .cache_dir = ""};
    assert_null(renderer_create(&options, studio.pool, &err));
    assert_int_equal(err.code, ERROR_USAGE);
    assert_non_null(strstr(err.message, "/nonexistent/shaders"));
    studio_close(&studio);
    /* A folder without shaders: the first frame says which file is missing. */
    assert_true(studio_open(&studio, folder.path, NULL));
    struct set set = set_load(&studio, "builtin:box");
    err = (struct error){0};
    assert_false(renderer_submit(studio.renderer, set.uploaded, &set.settings, 0, &err));
    assert_int_equal(err.code, ERROR_DATA);
    assert_non_null(strstr(err.message, "not found"));
    set_strike(&set);
    studio_close(&studio);
    folder_remove(&folder);
}

struct cached {
    char name[64];
    struct stat stat;
};

static size_t list_cache(const char *path, struct cached *out, size_t max)
{
    char names[64][64];
    size_t n = list(path, names, max < 64 ? max : 64);
    for (size_t i = 0; i < n; i++) {
        char full[400];
        snprintf(full, sizeof full, "%s/%s", path, names[i]);
        memcpy(out[i].name, names[i], sizeof out[i].name);
        assert_int_equal(stat(full, &out[i].stat), 0);
    }
    return n;
}

static struct shot picture_with_cache(const char *path)
{
    struct studio studio;
    assert_true(studio_open(&studio, NULL, path));
    struct set set = set_load(&studio, "builtin:box");
    set.settings.resolve_pass = RESOLVE_PASS_GPU;
    struct shot shot = shot_take(&studio, &set);
    set_strike(&set);
    studio_close(&studio);
    return shot;
}

static void spoil(const char *path, const char *name, size_t how)
{
    char full[400];
    snprintf(full, sizeof full, "%.255s/%.63s", path, name);
    FILE *f = fopen(full, how == 0 ? "wb" : "r+b");
    assert_non_null(f);
    /* Empty; a word of the header; nonsense all over; half of it. */
    if (how == 1)
        assert_int_equal(fwrite("\377\377\377\377", 1, 4, f), 4);
    for (int i = 0; how == 2 && i < 4096; i++)
        fputc((i * 7919) >> 3 & 255, f);
    assert_int_equal(fclose(f), 0);
    struct stat st;
    assert_int_equal(stat(full, &st), 0);
    if (how == 3)
        assert_int_equal(truncate(full, st.st_size / 2), 0);
}

static void test_program_cache(void **state)
{
    (void)state;
    struct folder folder = folder_make();
    struct shot first = picture_with_cache(folder.path);
    struct cached before[64], after[64];
    size_t n = list_cache(folder.path, before, 64);
    if (n == 0) {
        shot_drop(&first);
        folder_remove(&folder);
        skip(); /* a driver without program binaries */
    }
    assert_true(n >= 3 && n < 64);
    /* A hit writes nothing: the files stay the same ones. */
    struct shot second = picture_with_cache(folder.path);
    assert_true(shot_same(&first, &second));
    assert_int_equal(list_cache(folder.path, after, 64), n);
    for (size_t i = 0; i < n; i++) {
        assert_true(before[i].stat.st_ino == after[i].stat.st_ino);
        assert_true(before[i].stat.st_mtim.tv_nsec == after[i].stat.st_mtim.tv_nsec);
    }
    for (size_t how = 0; how < 4; how++) {
        for (size_t i = 0; i < n; i++)
            spoil(folder.path, after[i].name, how);
        struct shot third = picture_with_cache(folder.path);
        assert_true(shot_same(&first, &third));
        shot_drop(&third);
        /* And it was mended. */
        struct cached now[64];
        assert_int_equal(list_cache(folder.path, now, 64), n);
        for (size_t i = 0; i < n; i++)
            assert_true(now[i].stat.st_size > 100);
    }
    shot_drop(&first);
    shot_drop(&second);
    folder_remove(&folder);
}

/* Where no cache can be, pictures are made without. */
static void test_unwritable_cache(void **state)
{
    (void)state;
    struct shot with_none = picture_with_cache(""), in_a_file = picture_with_cache("/dev/null/cache");
    assert_true(shot_same(&with_none, &in_a_file));
    shot_drop(&with_none);
    shot_drop(&in_a_file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hot_reload),
        cmocka_unit_test(test_reload_prepares_anew),
        cmocka_unit_test(test_wrong_folders_are_told),
        cmocka_unit_test(test_program_cache),
        cmocka_unit_test(test_unwritable_cache),
    };
    struct studio studio;
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    studio_close(&studio);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
