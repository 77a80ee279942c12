/* What a scene may and may not reach: its own folder, through no link that leaves it, and regular files only. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/error.h"
#include "import/import.h"

static char root[64], scene_folder[80];

static void write_file(const char *folder, const char *name, const void *data, size_t size)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
}

static void link_to(const char *target, const char *name)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", scene_folder, name);
    assert_int_equal(symlink(target, path), 0);
}

static int set_up(void **state)
{
    (void)state;
    static const float triangle[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    char path[256];
    snprintf(root, sizeof root, "/tmp/gnomon-folder-XXXXXX");
    if (!mkdtemp(root))
        return 1;
    snprintf(scene_folder, sizeof scene_folder, "%s/scene", root);
    mkdir(scene_folder, 0755);
    snprintf(path, sizeof path, "%s/deeper", scene_folder);
    mkdir(path, 0755);
    write_file(root, "secret.bin", triangle, sizeof triangle);
    write_file(scene_folder, "own.bin", triangle, sizeof triangle);
    write_file(scene_folder, "with space.bin", triangle, sizeof triangle);
    write_file(path, "own.bin", triangle, sizeof triangle);
    link_to("own.bin", "inside.bin");
    link_to("../secret.bin", "outside.bin");
    link_to("..", "up");
    link_to("/", "slash");
    snprintf(path, sizeof path, "%s/pipe.bin", scene_folder);
    return mkfifo(path, 0644);
}

static int clean_up(void **state)
{
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", root);
    return system(command);
}

/* The message, or NULL if it loaded. */
static const char *load_with(const char *uri)
{
    static struct error err;
    char text[800], path[200];
    snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"
        "\"type\":\"VEC3\"}],\"buffers\":[{\"byteLength\":36,\"uri\":\"%s\"}]}",
        uri);
    write_file(scene_folder, "scene.gltf", text, strlen(text));
    snprintf(path, sizeof path, "%s/scene.gltf", scene_folder);
    struct import_report report = {0};
    memset(&err, 0, sizeof err);
    struct scene *scene = import_gltf(path, &report, &err);
    free(report.warnings);
    scene_destroy(scene);
    assert_true(scene != NULL || err.code == ERROR_DATA);
    return scene ? NULL : err.message;
}

static void own_files_load(void **state)
{
    (void)state;
    const char *const uris[] = {"own.bin",   "./own.bin",        "deeper/own.bin", "deeper//own.bin",
                                "own%2ebin", "with%20space.bin", "with space.bin", "inside.bin"};
    for (size_t i = 0; i < sizeof uris / sizeof *uris; i++) {
        const char *message = load_with(uris[i]);
        if (message)
            fail_msg("%s: %s", uris[i], message);
    }
}

static void others_do_not(void **state)
{
    (void)state;
    const char *const uris[] = {"../secret.bin",
                                "deeper/../../secret.bin",
                                "%2e%2e/secret.bin",
                                "..%2fsecret.bin",
                                "/etc/passwd",
                                "%2fetc%2fpasswd",
                                "outside.bin",
                                "up/secret.bin",
                                "slash/etc/passwd",
                                "pipe.bin",
                                "deeper",
                                "",
                                ".",
                                "own.bin%00.txt",
                                "file:own.bin",
                                "http://a.b/own.bin",
                                "own.bin/x",
                                "nothing.bin",
                                "deeper/../own.bin"};
    for (size_t i = 0; i < sizeof uris / sizeof *uris; i++)
        if (!load_with(uris[i]))
            fail_msg("\"%s\" was read", uris[i]);
}

static void no_scene_is_no_input(void **state)
{
    (void)state;
    struct error err = {0};
    char path[200];
    snprintf(path, sizeof path, "%s/none.gltf", scene_folder);
    assert_null(import_gltf(path, NULL, &err));
    assert_int_equal(err.code, ERROR_NO_INPUT);
    memset(&err, 0, sizeof err);
    assert_null(import_gltf(scene_folder, NULL, &err));
    assert_int_equal(err.code, ERROR_DATA);
    memset(&err, 0, sizeof err);
    snprintf(path, sizeof path, "%s/pipe.bin", scene_folder);
    assert_null(import_gltf(path, NULL, &err));
    assert_int_equal(err.code, ERROR_DATA);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(own_files_load),
        cmocka_unit_test(others_do_not),
        cmocka_unit_test(no_scene_is_no_input),
    };
    return cmocka_run_group_tests(tests, set_up, clean_up);
}
