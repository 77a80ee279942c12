/* Pictures in and out. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <dirent.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/error.h"
#include "import/import.h"

#define W 37
#define H 23

static void fill(uint8_t *rgba, bool alpha)
{
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            uint8_t *p = rgba + 4 * (y * W + x);
            p[0] = (uint8_t)(x * 6);
            p[1] = (uint8_t)(y * 10);
            p[2] = 128;
            p[3] = alpha ? (uint8_t)(40 + x * 5) : 255;
        }
}

static int largest_difference(const uint8_t *a, const uint8_t *b, int channels)
{
    int most = 0;
    for (int i = 0; i < W * H; i++)
        for (int k = 0; k < channels; k++) {
            int d = abs(a[4 * i + k] - b[4 * i + k]);
            most = d > most ? d : most;
        }
    return most;
}

static void round_trip(enum image_format format, bool alpha, int tolerance)
{
    uint8_t pixels[4 * W * H], *encoded = NULL;
    size_t size = 0;
    struct error err = {0};
    struct image image = {0};
    fill(pixels, alpha);
    if (!image_encode(format, pixels, W, H, 95, NULL, 0, &encoded, &size, &err))
        fail_msg("%s", err.message);
    if (!image_decode(encoded, size, "picture", &image, &err))
        fail_msg("%s", err.message);
    assert_int_equal(image.width, W);
    assert_int_equal(image.height, H);
    assert_true(largest_difference(pixels, image.rgba, 4) <= tolerance);
    for (size_t cut = 0; cut < size; cut += 1 + size / 40) {
        struct image none = {0};
        struct error why = {0};
        uint8_t *part = malloc(cut + 1);
        assert_non_null(part);
        memcpy(part, encoded, cut);
        if (!image_decode(part, cut, "picture", &none, &why))
            assert_int_equal(why.code, ERROR_DATA);
        free(none.rgba);
        free(part);
    }
    free(image.rgba);
    free(encoded);
}

static void png_keeps_every_bit(void **state)
{
    (void)state;
    round_trip(IMAGE_PNG, false, 0);
    round_trip(IMAGE_PNG, true, 0);
}

static void jpeg_and_webp_come_near(void **state)
{
    (void)state;
    round_trip(IMAGE_JPEG, false, 12);
    round_trip(IMAGE_WEBP, false, 24);
}

static void quality_counts(void **state)
{
    (void)state;
    const enum image_format formats[] = {IMAGE_JPEG, IMAGE_WEBP};
    uint8_t pixels[4 * W * H];
    fill(pixels, false);
    for (int i = 0; i < W * H; i++)
        pixels[4 * i] ^= (uint8_t)(i * 73);
    for (int f = 0; f < 2; f++) {
        uint8_t *low = NULL, *high = NULL;
        size_t low_size = 0, high_size = 0;
        struct error err = {0};
        assert_true(image_encode(formats[f], pixels, W, H, 20, NULL, 0, &low, &low_size, &err));
        assert_true(image_encode(formats[f], pixels, W, H, 95, NULL, 0, &high, &high_size, &err));
        assert_true(low_size < high_size);
        free(low);
        free(high);
    }
}

static bool contains(const uint8_t *data, size_t size, const char *text)
{
    return memmem(data, size, text, strlen(text)) != NULL;
}

static void metadata_are_kept(void **state)
{
    (void)state;
    const struct image_metadata metadata[] = {{"gnomon:algorithm", "sm:size=1024"}, {"gnomon:scene", "abc123"}};
    float linear[4 * 2] = {1.5f, 0, 0, 1, 0, 7, 0, 1};
    uint8_t pixels[4 * 2] = {0}, *data = NULL;
    size_t size = 0;
    struct error err = {0};
    assert_true(image_encode(IMAGE_EXR, linear, 2, 1, 90, metadata, 2, &data, &size, &err));
    assert_true(size > 4 && memcmp(data, "\x76\x2f\x31\x01", 4) == 0);
    assert_true(contains(data, size, "gnomon:algorithm") && contains(data, size, "sm:size=1024"));
    free(data);
    assert_true(image_encode(IMAGE_PNG, pixels, 2, 1, 90, metadata, 2, &data, &size, &err));
    assert_true(contains(data, size, "gnomon:algorithm") && contains(data, size, "sm:size=1024"));
    free(data);
}

/* Sizes are looked at before memory is asked for. */
static void absurd_sizes_are_refused(void **state)
{
    (void)state;
    const uint8_t png[] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\xea\x60\0\0\xea\x60\x08\6\0\0\0\0\0\0\0";
    const uint8_t jpeg[] = "\xff\xd8\xff\xe0\0\4ab\xff\xc0\0\x11\x08\xff\xff\xff\xff\3\1\x22\0\2\x11\1\3\x11\1";
    const uint8_t webp[] = "RIFF\x40\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xff\xff\xff\xff\xff\xff\0\0";
    const struct {
        const uint8_t *data;
        size_t size;
    } all[] = {{png, sizeof png}, {jpeg, sizeof jpeg}, {webp, sizeof webp}};
    for (int i = 0; i < 3; i++) {
        struct error err = {0};
        struct image image = {0};
        assert_false(image_decode(all[i].data, all[i].size, "picture", &image, &err));
        assert_int_equal(err.code, ERROR_DATA);
        if (!strstr(err.message, "a side are accepted"))
            fail_msg("%s", err.message);
    }
    struct error err = {0};
    struct image image = {0};
    assert_false(image_decode((const uint8_t *)"GIF89a", 6, "picture", &image, &err));
    assert_non_null(strstr(err.message, "no PNG, JPEG or WebP"));
    assert_null(image.rgba);
}

static void names_give_formats(void **state)
{
    (void)state;
    enum image_format format;
    assert_true(image_format_from_name("a.b/c.PNG", &format) && format == IMAGE_PNG);
    assert_true(image_format_from_name("x.jpeg", &format) && format == IMAGE_JPEG);
    assert_true(image_format_from_name("x.jpg", &format) && format == IMAGE_JPEG);
    assert_true(image_format_from_name("frame.0001.exr", &format) && format == IMAGE_EXR);
    assert_true(image_format_from_name("x.webp", &format) && format == IMAGE_WEBP);
    assert_false(image_format_from_name("png", &format));
    assert_false(image_format_from_name("x.gif", &format));
}

static void written_whole_or_not_at_all(void **state)
{
    (void)state;
    char folder[] = "/tmp/gnomon-image-XXXXXX", path[64], missing[64];
    uint8_t pixels[4 * W * H];
    struct error err = {0};
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/out.png", folder);
    snprintf(missing, sizeof missing, "%s/none/out.png", folder);
    fill(pixels, false);
    assert_true(image_write(path, IMAGE_PNG, pixels, W, H, 90, NULL, 0, &err));
    assert_true(image_write(path, IMAGE_PNG, pixels, W, H, 90, NULL, 0, &err));
    struct stat info;
    assert_true(stat(path, &info) == 0 && info.st_size > 100);
    assert_false(image_write(missing, IMAGE_PNG, pixels, W, H, 90, NULL, 0, &err));
    assert_int_equal(err.code, ERROR_IO);
    /* A folder of the wanted name: the rename fails, and nothing stays behind. */
    memset(&err, 0, sizeof err);
    snprintf(missing, sizeof missing, "%s/dir.png", folder);
    assert_int_equal(mkdir(missing, 0755), 0);
    assert_false(image_write(missing, IMAGE_PNG, pixels, W, H, 90, NULL, 0, &err));
    assert_int_equal(err.code, ERROR_IO);
    DIR *dir = opendir(folder);
    int count = 0;
    while (readdir(dir))
        count++;
    closedir(dir);
    assert_int_equal(count, 4); /* ., .., out.png, dir.png */
    rmdir(missing);
    unlink(path);
    rmdir(folder);
}

static void *encode_and_decode(void *context)
{
    pthread_barrier_t *start = context;
    bool right = true;
    pthread_barrier_wait(start);
    for (int i = 0; i < 100; i++) {
        uint8_t pixels[4 * W * H], *encoded = NULL;
        size_t size = 0;
        struct error err = {0};
        struct image image = {0};
        fill(pixels, true);
        right = right && image_encode(IMAGE_PNG, pixels, W, H, 95, NULL, 0, &encoded, &size, &err) &&
                image_decode(encoded, size, "picture", &image, &err) && memcmp(pixels, image.rgba, sizeof pixels) == 0;
        free(image.rgba);
        free(encoded);
    }
    return right ? context : NULL;
}

static void many_threads_at_once(void **state)
{
    (void)state;
    enum { THREADS = 8 };
    pthread_t threads[THREADS];
    pthread_barrier_t start;
    pthread_barrier_init(&start, NULL, THREADS);
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, encode_and_decode, &start), 0);
    int right = 0;
    for (int i = 0; i < THREADS; i++) {
        void *result = NULL;
        pthread_join(threads[i], &result);
        right += result != NULL;
    }
    pthread_barrier_destroy(&start);
    assert_int_equal(right, THREADS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_threads_at_once), /* first: what it looks for is in how OpenImageIO starts */
        cmocka_unit_test(png_keeps_every_bit),
        cmocka_unit_test(jpeg_and_webp_come_near),
        cmocka_unit_test(quality_counts),
        cmocka_unit_test(metadata_are_kept),
        cmocka_unit_test(absurd_sizes_are_refused),
        cmocka_unit_test(names_give_formats),
        cmocka_unit_test(written_whole_or_not_at_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
