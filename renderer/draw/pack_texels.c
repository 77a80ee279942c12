#include "draw/pack_texels.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "scene/scene.h"

static uint32_t half(uint32_t side) { return side > 1 ? side / 2 : 1; }

static uint32_t level_count(const struct image *image)
{
    uint32_t levels = 1;
    for (uint32_t w = image->width, h = image->height; w > 1 || h > 1; w = half(w), h = half(h))
        levels++;
    return levels;
}

static size_t texels_with_levels(const struct image *image)
{
    size_t sum = 1;
    uint32_t w = image->width, h = image->height;
    for (; w > 1 || h > 1; w = half(w), h = half(h))
        sum += (size_t)w * h;
    return sum;
}

/* 2 x 2 box; an odd last row or column is left out, as is usual. Averaged as stored: a mip of an sRGB image is a little dark, which
 * nobody has seen yet. */
static void make_level(const uint8_t *from, uint32_t w, uint32_t h, uint8_t *to)
{
    uint32_t w2 = half(w), h2 = half(h);
    for (uint32_t y = 0; y < h2; y++)
        for (uint32_t x = 0; x < w2; x++) {
            uint32_t x1 = 2 * x + 1 < w ? 2 * x + 1 : 2 * x, y1 = 2 * y + 1 < h ? 2 * y + 1 : 2 * y;
            size_t corners[4] = {(size_t)2 * y * w + 2 * x, (size_t)2 * y * w + x1, (size_t)y1 * w + 2 * x, (size_t)y1 * w + x1};
            for (int c = 0; c < 4; c++) {
                unsigned sum = 2;
                for (int i = 0; i < 4; i++)
                    sum += from[corners[i] * 4 + (size_t)c];
                to[((size_t)y * w2 + x) * 4 + (size_t)c] = (uint8_t)(sum / 4);
            }
        }
}

static void pack_image(const struct image *image, uint32_t *out)
{
    memcpy(out, image->rgba, (size_t)image->width * image->height * 4);
    for (uint32_t w = image->width, h = image->height; w > 1 || h > 1; w = half(w), h = half(h)) {
        uint32_t *next = out + (size_t)w * h;
        make_level((const uint8_t *)out, w, h, (uint8_t *)next);
        out = next;
    }
}

bool pack_texels(struct packed_texels *out, const struct scene *scene, size_t max_texels, struct error *err)
{
    memset(out, 0, sizeof *out);
    size_t *firsts = calloc(scene->image_count + 1, sizeof *firsts);
    out->textures = calloc(scene->texture_count + 1, sizeof *out->textures);
    for (size_t i = 0; firsts && i < scene->image_count; i++)
        firsts[i + 1] = firsts[i] + texels_with_levels(&scene->images[i]);
    bool fits = firsts && firsts[scene->image_count] <= max_texels;
    out->texel_count = fits ? firsts[scene->image_count] : 0;
    out->texels = fits ? malloc((out->texel_count + 1) * sizeof *out->texels) : NULL;
    if (!out->texels || !out->textures) {
        bool too_many = firsts && !fits;
        free(firsts);
        packed_texels_finish(out);
        return too_many ? error_set(err, ERROR_TRY_AGAIN, NULL,
                                    "the scene's images have more texels than this device reads (%zu)", max_texels)
                        : error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the scene's images");
    }
    for (size_t i = 0; i < scene->image_count; i++)
        pack_image(&scene->images[i], out->texels + firsts[i]);
    for (size_t i = 0; i < scene->texture_count; i++) {
        const struct texture *t = &scene->textures[i];
        const struct image *image = &scene->images[t->image];
        uint32_t info[4] = {(uint32_t)firsts[t->image], image->width | image->height << 16,
                            (uint32_t)t->wrap_s | (uint32_t)t->wrap_t << 8 | (uint32_t)t->nearest << 16, level_count(image)};
        memcpy(out->textures[i], info, sizeof info);
    }
    free(firsts);
    return true;
}

void packed_texels_finish(struct packed_texels *p)
{
    free(p->textures);
    free(p->texels);
    memset(p, 0, sizeof *p);
}
