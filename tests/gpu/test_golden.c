/* Pictures against those under golden/: README.md here says how one is made anew. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#include "base/error.h"
#include "import/import.h"
#include "studio.h"

#define WIDTH      160
#define HEIGHT     90
/* By how much the light of golden/wrong.png is turned, degrees. */
#define WRONG_TURN 2

static struct studio studio;

static const struct golden {
    const char *name, *scene, *algorithm;
    enum show show;
    enum camera_pass pass;
    int largest;     /* channel difference, of 255 */
    double fraction; /* of pixels that may differ by more */
} goldens[] = {
#define RASTER                                                        CAMERA_PASS_RASTER
#define TRACED                                                        CAMERA_PASS_TRACED
#define GOLDEN(name, scene, algorithm, show, pass, largest, fraction) {name, scene, algorithm, show, pass, largest, fraction},
#include "goldens.def"
#undef GOLDEN
};

static const size_t golden_count = sizeof goldens / sizeof goldens[0];

static void golden_path(char out[300], const char *name) { snprintf(out, 300, "%s/tests/gpu/golden/%s.png", SOURCE_DIR, name); }

/* Both producers fixed, and exposure and tone curve at their defaults, so that the same picture comes out. */
static struct shot take(const struct golden *g, double turned)
{
    char name[80];
    snprintf(name, sizeof name, "builtin:%s", g->scene);
    struct set set = set_load(&studio, name);
    set.settings.width = WIDTH;
    set.settings.height = HEIGHT;
    set.settings.show = g->show;
    set.settings.camera_pass = g->pass;
    set.settings.map_pass = g->pass;
    set.settings.lights[0] = light_turned(set.scene, &set.settings.lights[0], turned);
    set_use(&set, g->algorithm);
    struct shot shot = shot_take(&studio, &set);
    set_strike(&set);
    return shot;
}

/* Fraction of pixels that differ by more than `largest` in some channel. `difference`: RGBA, amplified, may be NULL. */
static double failing(const uint8_t *a, const uint8_t *b, int largest, uint8_t *difference)
{
    size_t count = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        int most = 0;
        for (size_t k = 4 * i; k < 4 * i + 4; k++) {
            int d = abs((int)a[k] - (int)b[k]);
            most = d > most ? d : most;
            if (difference)
                difference[k] = k % 4 == 3 ? 255 : (uint8_t)(8 * d < 255 ? 8 * d : 255);
        }
        count += most > largest;
    }
    return (double)count / (WIDTH * HEIGHT);
}

static void write_png(const char *path, const uint8_t *pixels)
{
    struct error err = {0};
    if (!image_write(path, IMAGE_PNG, pixels, WIDTH, HEIGHT, 100, NULL, 0, &err))
        fail_msg("%s", err.message);
}

/* False when there is none. */
static bool read_golden(const char *name, struct image *out)
{
    char path[300];
    struct error err = {0};
    golden_path(path, name);
    FILE *f = fopen(path, "rb");
    if (!f)
        return false;
    static uint8_t data[1 << 20];
    size_t size = fread(data, 1, sizeof data, f);
    fclose(f);
    if (!image_decode(data, size, path, out, &err))
        fail_msg("%s", err.message);
    assert_int_equal(out->width, WIDTH);
    assert_int_equal(out->height, HEIGHT);
    return true;
}

/* Picture and difference go to the build folder. */
static void keep(const char *name, const uint8_t *pixels, const uint8_t *difference)
{
    char path[300];
    mkdir(BINARY_DIR "/golden", 0777);
    snprintf(path, sizeof path, "%s/golden/%s.png", BINARY_DIR, name);
    write_png(path, pixels);
    snprintf(path, sizeof path, "%s/golden/%s.difference.png", BINARY_DIR, name);
    write_png(path, difference);
}

/* The number of failures: 0 or 1. */
static int compare(const struct golden *g)
{
    static uint8_t difference[WIDTH * HEIGHT * 4];
    struct image golden;
    if (!read_golden(g->name, &golden)) {
        print_error("%s: there is no golden/%s.png\n", g->name, g->name);
        return 1;
    }
    struct shot shot = take(g, 0);
    double fraction = failing(shot.pixels, golden.rgba, g->largest, difference);
    if (fraction > g->fraction) {
        keep(g->name, shot.pixels, difference);
        print_error("%s: %.4f of the pixels differ by more than %d, at most %.4f may; see %s/golden/%s*.png\n", g->name, fraction,
                    g->largest, g->fraction, BINARY_DIR, g->name);
    }
    shot_drop(&shot);
    free(golden.rgba);
    return fraction > g->fraction;
}

static void test_pictures_equal_their_goldens(void **state)
{
    (void)state;
    int failures = 0;
    for (size_t i = 0; i < golden_count; i++)
        failures += compare(&goldens[i]);
    assert_int_equal(failures, 0);
}

/* golden/wrong.png is box-sm with the light turned a little: the comparison must find fault with it. And with
 * every other scene's golden. */
static void test_wrong_pictures_are_found(void **state)
{
    (void)state;
    struct image right, wrong;
    assert_true(read_golden("box-sm", &right));
    assert_true(read_golden("wrong", &wrong));
    assert_true(strcmp(goldens[0].name, "box-sm") == 0);
    double fraction = failing(right.rgba, wrong.rgba, goldens[0].largest, NULL);
    if (!(fraction > goldens[0].fraction && fraction < 0.1))
        fail_msg("wrong.png differs from box-sm.png in %.4f of its pixels: %.4f to 0.1 was meant", fraction, goldens[0].fraction);
    for (size_t i = 1; i < golden_count; i++) {
        struct image other;
        assert_true(read_golden(goldens[i].name, &other));
        if (strcmp(goldens[i].scene, "box") != 0 &&
            !(failing(right.rgba, other.rgba, goldens[i].largest, NULL) > goldens[i].fraction))
            fail_msg("%s passes for box-sm", goldens[i].name);
        free(other.rgba);
    }
    free(right.rgba);
    free(wrong.rgba);
}

/* GNOMON_GOLDEN_WRITE=NAME: one by name, on purpose; "wrong" too. */
static int write_one(const char *name)
{
    char path[300];
    bool wrong = strcmp(name, "wrong") == 0;
    golden_path(path, name);
    for (size_t i = 0; i < golden_count; i++)
        if (strcmp(goldens[i].name, wrong ? "box-sm" : name) == 0) {
            struct shot shot = take(&goldens[i], wrong ? WRONG_TURN : 0);
            write_png(path, shot.pixels);
            shot_drop(&shot);
            printf("wrote %s: look at it\n", path);
            return 0;
        }
    fprintf(stderr, "no golden is called '%s'; goldens.def lists them\n", name);
    return 64;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pictures_equal_their_goldens),
        cmocka_unit_test(test_wrong_pictures_are_found),
    };
    const char *name = getenv("GNOMON_GOLDEN_WRITE");
    if (!studio_open(&studio, NULL, NULL))
        return 77;
    int result = name ? write_one(name) : cmocka_run_group_tests(tests, NULL, NULL);
    studio_close(&studio);
    return result;
}
