#include "difference.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "against.h"
#include "comparison.h"
#include "stage.h"

/* Orange and blue stay apart for every common kind of colour blindness. */
static const float LEAK_COLOR[3] = {255, 130, 0};
static const float ACNE_COLOR[3] = {40, 110, 255};
static const float GREY_SHARE = 0.5f;      /* of the picture's brightness */
static const float LEAST_STRENGTH = 0.35f; /* the smallest difference must be seen too */

/* The light with the largest difference at pixel `p`; light_count when the pixel counts for none. */
static size_t worst_light(const struct comparison *c, size_t p)
{
    size_t worst = c->light_count;
    float largest = -1;
    for (size_t i = 0; i < c->light_count; i++) {
        float d = fabsf(c->tested[i][p] - c->truth[i][p]);
        if (c->receiver[i][p] && d > largest) {
            largest = d;
            worst = i;
        }
    }
    return worst;
}

/* Rec. 709 luma of sRGB bytes. */
static float grey(const uint8_t *pixel) { return GREY_SHARE * (0.2126f * pixel[0] + 0.7152f * pixel[1] + 0.0722f * pixel[2]); }

void difference_paint(const struct comparison *c, uint8_t *rgba8)
{
    const uint8_t *picture = c->picture;
    for (size_t p = 0; p < (size_t)c->width * c->height; p++) {
        size_t light = worst_light(c, p);
        float d = light < c->light_count ? c->tested[light][p] - c->truth[light][p] : 0;
        float strength = d == 0 ? 0 : LEAST_STRENGTH + (1 - LEAST_STRENGTH) * fminf(fabsf(d), 1);
        const float *color = d > 0 ? LEAK_COLOR : ACNE_COLOR;
        float back = grey(picture + 4 * p);
        for (int i = 0; i < 3; i++)
            rgba8[4 * p + i] = (uint8_t)lrintf(back + (color[i] - back) * strength);
        rgba8[4 * p + 3] = 255;
    }
}

void difference_numbers(const struct comparison *c, float *rgba32f)
{
    for (size_t p = 0; p < (size_t)c->width * c->height; p++) {
        size_t light = worst_light(c, p);
        bool counts = light < c->light_count;
        float tested = counts ? c->tested[light][p] : 0, truth = counts ? c->truth[light][p] : 0;
        const float values[4] = {tested, truth, tested - truth, counts ? 1 : 0};
        for (int i = 0; i < 4; i++)
            rgba32f[4 * p + i] = values[i];
    }
}

enum { PICTURE_QUALITY = 90 }; /* JPEG and WebP */

bool difference_write(const struct comparison *c, const struct stage *stage, const struct against *against, const char *path,
                      enum image_format format, struct error *err)
{
    struct render_settings settings = stage->settings;
    char tested[300], truth[300];
    settings.format = format == IMAGE_EXR ? PIXELS_RGBA32F : PIXELS_RGBA8;
    void *pixels = stage_picture(&settings, err);
    if (!pixels)
        return false;
    if (format == IMAGE_EXR)
        difference_numbers(c, pixels);
    else
        difference_paint(c, pixels);
    shadow_format(settings.system, &settings.params, tested, sizeof tested);
    against_format(against, truth, sizeof truth);
    const struct image_metadata metadata[] = {
        {"Software", "gnomon " GNOMON_VERSION}, {"gnomon:algorithm", tested}, {"gnomon:against", truth}};
    bool good = image_write(path, format, pixels, c->width, c->height, PICTURE_QUALITY, metadata, 3, err);
    free(pixels);
    return good;
}
