#include "pictures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "comparison.h"
#include "difference.h"
#include "import/import.h"
#include "models.h"
#include "report.h"
#include "shots.h"

/* Small enough that single pixels are seen when a page enlarges them. */
enum { CROP_WIDTH = 240, CROP_HEIGHT = 150 };
enum { OVERVIEW_WIDTH = 640, JPEG_QUALITY = 88 };

/* sums[y * (width + 1) + x]: how many are wrong left of x and above y (Crow 1984). */
static uint32_t *sum_wrong(const struct bench_shot *s)
{
    size_t stride = (size_t)s->width + 1;
    uint32_t *sums = calloc(stride * (s->height + 1), sizeof *sums);
    for (uint32_t y = 0; sums && y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++) {
            size_t p = (size_t)y * s->width + x, at = (y + 1) * stride + x + 1;
            uint32_t wrong = s->receiver[p] && fabsf(s->tested[p] - s->truth[p]) > 0.5f;
            sums[at] = wrong + sums[at - 1] + sums[at - stride] - sums[at - stride - 1];
        }
    return sums;
}

struct crop crop_most_wrong(const struct bench_shot *s, uint32_t width, uint32_t height)
{
    struct crop c = {0, 0, width < s->width ? width : s->width, height < s->height ? height : s->height};
    size_t stride = (size_t)s->width + 1;
    uint32_t *sums = sum_wrong(s), most = 0;
    for (uint32_t y = 0; sums && y + c.height <= s->height; y++)
        for (uint32_t x = 0; x + c.width <= s->width; x++) {
            const uint32_t *top = sums + y * stride + x, *bottom = top + c.height * stride;
            uint32_t wrong = bottom[c.width] - bottom[0] - top[c.width] + top[0];
            if (wrong <= most)
                continue;
            most = wrong;
            c.x = x;
            c.y = y;
        }
    free(sums);
    return c;
}

/* Pictures being added to a figure. */
struct gallery {
    struct bench_report *report;
    size_t figure;
};

static void add(const struct gallery *g, enum image_format format, const uint8_t *rgba, uint32_t width, uint32_t height,
                const char *caption)
{
    struct error err = {0};
    struct bench_picture picture = {.figure = g->figure, .width = width, .height = height};
    picture.media = format == IMAGE_PNG ? "image/png" : "image/jpeg";
    snprintf(picture.caption, sizeof picture.caption, "%s", caption);
    if (!image_encode(format, rgba, width, height, JPEG_QUALITY, NULL, 0, &picture.data, &picture.size, &err))
        return;
    if (!array_push(&g->report->pictures, picture))
        free(picture.data);
}

static void add_crop(const struct gallery *g, const uint8_t *rgba, uint32_t stride, const struct crop *c, const char *caption)
{
    uint8_t *part = malloc((size_t)c->width * c->height * 4);
    for (uint32_t y = 0; part && y < c->height; y++)
        memcpy(part + (size_t)y * c->width * 4, rgba + ((size_t)(c->y + y) * stride + c->x) * 4, (size_t)c->width * 4);
    if (part)
        add(g, IMAGE_PNG, part, c->width, c->height, caption);
    free(part);
}

/* Means over blocks of whole pixels. */
static void add_overview(const struct gallery *g, const struct bench_shot *s, const char *caption)
{
    uint32_t by = s->width > OVERVIEW_WIDTH ? s->width / OVERVIEW_WIDTH : 1, width = s->width / by, height = s->height / by;
    uint8_t *small = height ? malloc((size_t)width * height * 4) : NULL;
    for (size_t i = 0; small && i < (size_t)width * height * 4; i++) {
        size_t x = i / 4 % width, y = i / 4 / width;
        uint32_t sum = 0;
        for (uint32_t k = 0; k < by * by; k++)
            sum += s->rgba[((y * by + k / by) * s->width + x * by + k % by) * 4 + i % 4];
        small[i] = (uint8_t)(sum / (by * by));
    }
    if (small)
        add(g, IMAGE_JPEG, small, width, height, caption);
    free(small);
}

/* The differences of two visibilities over the picture of the first. NULL when memory is out. */
static uint8_t *paint(const struct bench_shot *s, float *other)
{
    struct comparison c = {.width = s->width, .height = s->height, .light_count = 1, .picture = s->rgba};
    uint8_t *painted = malloc((size_t)s->width * s->height * 4);
    c.tested[0] = s->tested;
    c.truth[0] = other;
    c.receiver[0] = s->receiver;
    if (painted)
        difference_paint(&c, painted);
    return painted;
}

static size_t count_different(const struct bench_shot *a, const float *other)
{
    size_t n = 0;
    for (size_t p = 0; p < (size_t)a->width * a->height; p++)
        n += a->receiver[p] && fabsf(a->tested[p] - other[p]) > 0.5f;
    return n;
}

static void add_pictures(const struct gallery *g, const struct bench_shot *const *shots, size_t count, const struct crop *crop)
{
    char caption[400];
    snprintf(caption, sizeof caption, "The whole picture, %s", shots[0]->cell->name);
    add_overview(g, shots[0], caption);
    for (size_t i = 0; i < count; i++) {
        const struct bench_shot *s = shots[i];
        uint8_t *painted = paint(s, s->truth);
        add_crop(g, s->rgba, s->width, crop, s->cell->name);
        snprintf(caption, sizeof caption, "%s: %zu pixels wrong in the whole picture", s->cell->name,
                 count_different(s, s->truth));
        if (painted)
            add_crop(g, painted, s->width, crop, caption);
        free(painted);
    }
}

static void add_pairs(const struct gallery *g, const struct bench_shot *const *shots, size_t count, const struct crop *crop)
{
    for (size_t i = 0; i < count; i++)
        for (size_t k = i + 1; k < count; k++) {
            char caption[400];
            uint8_t *painted = paint(shots[i], shots[k]->tested);
            snprintf(caption, sizeof caption, "%s against %s: %zu pixels differ", shots[i]->cell->name, shots[k]->cell->name,
                     count_different(shots[i], shots[k]->tested));
            if (painted)
                add_crop(g, painted, shots[i]->width, crop, caption);
            free(painted);
        }
}

enum { FIGURE_SHOTS_MAX = 8 };

/* In the order of the figure's algorithms. */
static size_t shots_of(const struct bench_figure *figure, size_t index, const struct bench_shots *shots,
                       const struct bench_shot *out[FIGURE_SHOTS_MAX])
{
    size_t count = 0;
    for (size_t a = 0; figure->algorithms[a]; a++)
        for (size_t i = 0; i < shots->list.count && count < FIGURE_SHOTS_MAX; i++) {
            const struct bench_shot *s = &shots->list.data[i];
            const struct shadow_system *system;
            struct shadow_params params;
            struct error err = {0};
            if (s->cell->figures & 1u << index && shadow_parse(figure->algorithms[a], &system, &params, &err) &&
                s->cell->system == system &&
                !memcmp(s->cell->params.value, params.value, system->param_count * sizeof params.value[0]))
                out[count++] = s;
        }
    return count;
}

void bench_pictures_make(struct bench_report *report, const struct bench_shots *shots)
{
    const struct bench_figure *const *figures = report->plan.suite->figures;
    for (size_t i = 0; figures && figures[i]; i++) {
        const struct bench_shot *of[FIGURE_SHOTS_MAX];
        const struct gallery gallery = {report, i};
        size_t count = shots_of(figures[i], i, shots, of);
        if (count == 0)
            continue;
        struct crop crop = crop_most_wrong(of[0], CROP_WIDTH, CROP_HEIGHT);
        if (figures[i]->kind == FIGURE_PICTURES)
            add_pictures(&gallery, of, count, &crop);
        else
            add_pairs(&gallery, of, count, &crop);
    }
}
