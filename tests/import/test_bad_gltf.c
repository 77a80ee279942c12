/* Every broken or hostile file of the shared folder: no crash, under 5 s, a sentence for each refusal, and nothing opened outside the file's
 * folder. open, openat and openat2 are replaced here, so that every file the process opens is seen. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/error.h"
#include "import/import.h"
#include "walk.h"

static char allowed[PATH_MAX]; /* while a file is loaded: its folder */
static unsigned opened, outside;

static int seen(int fd)
{
    char link[64], path[PATH_MAX];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t n = fd >= 0 && allowed[0] ? readlink(link, path, sizeof path - 1) : -1;
    if (n < 0)
        return fd;
    path[n] = 0;
    size_t length = strlen(allowed);
    opened++;
    if (strncmp(path, allowed, length) != 0 || (path[length] != '/' && path[length] != 0)) {
        fprintf(stderr, "opened %s\n", path);
        outside++;
    }
    return fd;
}

int open(const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    int mode = va_arg(args, int);
    va_end(args);
    int (*real)(const char *, int, ...) = (int (*)(const char *, int, ...))dlsym(RTLD_NEXT, "open");
    return seen(real(path, flags, mode));
}

int openat(int at, const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    int mode = va_arg(args, int);
    va_end(args);
    int (*real)(int, const char *, int, ...) = (int (*)(int, const char *, int, ...))dlsym(RTLD_NEXT, "openat");
    return seen(real(at, path, flags, mode));
}

long syscall(long number, ...)
{
    long a[6];
    va_list args;
    va_start(args, number);
    for (int i = 0; i < 6; i++)
        a[i] = va_arg(args, long);
    va_end(args);
    long (*real)(long, ...) = (long (*)(long, ...))dlsym(RTLD_NEXT, "syscall");
    long result = real(number, a[0], a[1], a[2], a[3], a[4], a[5]);
    if (number == SYS_openat2)
        seen((int)result);
    return result;
}

/* NULL: must load; else what the refusal must say. Of the set made for this project, and the valid ones of the others. */
static const struct {
    const char *file, *part;
} expected[] = {
    {"made-here/ok-control.glb", NULL},
    {"made-here/deep-20000-nodes.glb", NULL},
    {"made-here/json-nul-inside.gltf", NULL},
    {"made-here/scale-zero.glb", NULL},
    {"made-here/triangle-degenerate.glb", NULL},
    {"made-here/minmax-lies.glb", NULL},
    {"meshoptimizer/fuzz.glb", NULL},
    {"asset-generator/Mesh_NoPosition/Mesh_NoPosition_00.gltf", NULL},
    {"asset-generator/Mesh_NoPosition/Mesh_NoPosition_01.gltf", NULL},
    {"made-here/buffer-claims-1TiB.glb", "buffers[0].byteLength"},
    {"made-here/camera-zero.glb", "yfov"},
    {"made-here/component-type-0.glb", "componentType"},
    {"made-here/count-huge.glb", "accessors[0].count"},
    {"made-here/count-negative.glb", "accessors[0].count is -3"},
    {"made-here/count-one-past.glb", "accessors[0] needs 4"},
    {"made-here/count-overflow.glb", "accessors[0].count"},
    {"made-here/cut-at-12.glb", "ends after 12"},
    {"made-here/cut-at-20.glb", "cut off"},
    {"made-here/cut-at-30.glb", "cut off"},
    {"made-here/cut-at-4.glb", "ends after 4"},
    {"made-here/cut-at-538.glb", "cut off"},
    {"made-here/draco-garbage.glb", "KHR_draco_mesh_compression"},
    {"made-here/empty.glb", "empty"},
    {"made-here/empty.gltf", "empty"},
    {"made-here/image-60000x60000.glb", "60000 x 60000"},
    {"made-here/image-not-png.glb", "no PNG, JPEG or WebP"},
    {"made-here/index-out-of-range.glb", "holds 60000"},
    {"made-here/indices-float.glb", "accessors[1]"},
    {"made-here/json-chunk-4GiB.glb", "4294967280"},
    {"made-here/json-duplicate-keys.gltf", "twice"},
    {"made-here/json-nested-100000.gltf", "nested"},
    {"made-here/json-null.gltf", "object"},
    {"made-here/json-trailing-garbage.gltf", "JSON"},
    {"made-here/json-utf8-bad.gltf", "UTF-8"},
    {"made-here/light-bad.glb", "KHR_lights_punctual"},
    {"made-here/matrix-15.glb", "15 numbers"},
    {"made-here/mesh-missing.glb", "names entry 7 of meshes"},
    {"made-here/mesh-negative.glb", "names entry -1 of meshes"},
    {"made-here/mesh-no-primitives.glb", "primitives"},
    {"made-here/min-version-9.glb", "minVersion"},
    {"made-here/mode-99.glb", "mode is 99"},
    {"made-here/node-cycle-3.glb", "cycle"},
    {"made-here/node-doubling-40.glb", "parent"},
    {"made-here/node-self-child.glb", "cycle"},
    {"made-here/not-gltf.glb", "JSON"},
    {"made-here/offset-negative.glb", "byteOffset is -36"},
    {"made-here/offset-wrap.glb", "byteOffset"},
    {"made-here/positions-inf.glb", "finite"},
    {"made-here/positions-nan.glb", "finite"},
    {"made-here/required-unknown.glb", "VENDOR_does_not_exist"},
    {"made-here/scene-missing.glb", "names entry 5 of scenes"},
    {"made-here/sparse-count-over.glb", "sparse.count"},
    {"made-here/stride-huge.glb", "252 apart"},
    {"made-here/total-4GiB.glb", "4294967295"},
    {"made-here/total-short.glb", "chunk 0"},
    {"made-here/uri-absolute.gltf", "outside"},
    {"made-here/uri-data-bad.gltf", "base64"},
    {"made-here/uri-data-short.gltf", "byteLength"},
    {"made-here/uri-directory.gltf", "not a file"},
    {"made-here/uri-http.gltf", "scene's folder only"},
    {"made-here/uri-missing.gltf", "nowhere.bin"},
    {"made-here/uri-parent.gltf", "outside"},
    {"made-here/version-3.glb", "version 3"},
    {"assimp/RecursiveNodes/RecursiveNodes.gltf", "cycle"},
    {"assimp/MissingBin/BoxTextured.gltf", "BoxTextured0.bin"},
    {"assimp/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", "finite"},
    {"validator/image/not_found.gltf", "not_found.png"},
    {"validator/buffer/not_found.gltf", "cannot be opened"},
};

static unsigned judged, made_here;

static void judge(const char *file, const struct scene *scene, const struct error *err)
{
    made_here += strncmp(file, "made-here/", 10) == 0;
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        if (strcmp(expected[i].file, file) != 0)
            continue;
        judged++;
        if (!expected[i].part != !!scene || (expected[i].part && !strstr(err->message, expected[i].part)))
            fail_msg("%s: %s", file, scene ? "was accepted" : err->message);
        return;
    }
    if (strncmp(file, "made-here/", 10) == 0)
        fail_msg("%s is in no table", file);
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static void load(const char *path, const char *below)
{
    struct error err = {0};
    struct import_report report = {0};
    char folder[PATH_MAX];
    snprintf(folder, sizeof folder, "%s", path);
    *strrchr(folder, '/') = 0;
    assert_non_null(realpath(folder, allowed));
    double start = now();
    struct scene *scene = import_gltf(path, &report, &err);
    double seconds = now() - start;
    allowed[0] = 0;
    assert_true(seconds < 5);
    assert_int_equal(outside, 0);
    if (!scene) {
        assert_int_equal(err.code, ERROR_DATA);
        assert_non_null(strstr(err.message, below));
        assert_true(strlen(err.message) > strlen(path) + 10);
    }
    judge(below, scene, &err);
    free(report.warnings);
    scene_destroy(scene);
}

static void every_bad_file(void **state)
{
    (void)state;
    if (access(SHARED_DIR "/bad-gltf", R_OK) != 0)
        skip();
    assert_true(walk(SHARED_DIR "/bad-gltf", load) > 200);
    assert_true(opened > 400);
    assert_true(made_here > 50);
    assert_int_equal(judged, sizeof expected / sizeof *expected);
}

/* The watcher sees what leaves the folder. */
static void watcher_can_fail(void **state)
{
    (void)state;
    snprintf(allowed, sizeof allowed, "/proc");
    close(open("/dev/null", O_RDONLY));
    allowed[0] = 0;
    assert_int_equal(outside, 1);
    outside = 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(watcher_can_fail), cmocka_unit_test(every_bad_file)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
