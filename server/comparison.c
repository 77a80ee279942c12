#include "comparison.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "stage.h"
#include "truth.h"

void comparison_finish(struct comparison *c)
{
    for (size_t i = 0; i < RENDERER_LIGHTS_MAX; i++) {
        free(c->tested[i]);
        free(c->truth[i]);
        free(c->receiver[i]);
        free(c->masks[i].receivers);
        free(c->masks[i].lit);
        list_reading_finish(&c->lists[i]);
        free(c->truth_masks[i].receivers);
        free(c->truth_masks[i].lit);
    }
    free(c->ids);
    free(c->one_triangle);
    free(c->picture);
    *c = (struct comparison){0};
}

static bool comparison_init(struct comparison *c, const struct render_settings *settings, struct error *err)
{
    *c = (struct comparison){.width = settings->width, .height = settings->height, .light_count = settings->light_count};
    size_t pixels = (size_t)c->width * c->height;
    c->ids = calloc(pixels, sizeof *c->ids);
    c->one_triangle = calloc(pixels, 1);
    c->picture = calloc(pixels, 4);
    bool good = c->ids && c->one_triangle && c->picture;
    for (size_t i = 0; i < c->light_count; i++) {
        c->wrong_samples[i] = -1;
        c->tested[i] = calloc(pixels, sizeof(float));
        c->truth[i] = calloc(pixels, sizeof(float));
        c->receiver[i] = calloc(pixels, 1);
        good = good && c->tested[i] && c->truth[i] && c->receiver[i];
    }
    if (good)
        return true;
    return error_set(err, ERROR_TRY_AGAIN, "size",
                     "memory is out for the visibility of %zu lights at %ux%u; a smaller --size is accepted", c->light_count,
                     c->width, c->height);
}

static bool read_visibility(struct stage *stage, const struct render_settings *settings, float *const *out, struct error *err)
{
    for (size_t i = 0; i < settings->light_count; i++)
        if (!renderer_read_visibility(stage->renderer, (unsigned)i, out[i]))
            return error_set(err, ERROR_TRY_AGAIN, NULL, "light %zu's visibility could not be read back from the device", i);
    return true;
}

/* Masks are a second copy of the picture and more: they are read only where truth has some to hold against them. */
static bool read_masks(struct stage *stage, unsigned light, struct comparison *c, struct error *err)
{
    struct sample_masks *m = &c->masks[light];
    size_t pixels = (size_t)c->width * c->height;
    if (!stage->settings.system->read_masks)
        return true;
    m->receivers = malloc(pixels * sizeof *m->receivers);
    m->lit = malloc(pixels * sizeof *m->lit);
    if (!m->receivers || !m->lit)
        return error_set(err, ERROR_TRY_AGAIN, "size", "memory is out for the masks of %zu pixels", pixels);
    if (renderer_read_masks(stage->uploaded, light, m->receivers, m->lit, err))
        return true;
    free(m->receivers);
    free(m->lit);
    *m = (struct sample_masks){0};
    return err->code == ERROR_NONE;
}

static bool read_what_it_tells(struct stage *stage, const struct against *against, struct comparison *c, struct error *err)
{
    for (unsigned i = 0; i < c->light_count; i++) {
        c->figure_count[i] = renderer_read_figures(stage->uploaded, i, c->figures[i]);
        if (against->kind == AGAINST_SAMPLES32 && !read_masks(stage, i, c, err))
            return false;
        if (!c->without_lists && !list_reading_take(stage, i, &c->lists[i], err))
            return false;
    }
    return true;
}

static bool render_tested(struct stage *stage, const struct against *against, struct comparison *c, struct error *err)
{
    struct render_settings settings = stage->settings;
    struct frame_info info;
    settings.aa = 1;
    settings.format = PIXELS_RGBA8;
    settings.show = SHOW_SHADED;
    if (!stage_converge(stage, &settings, c->picture, &info, &c->converge_frames, err) ||
        !read_visibility(stage, &settings, c->tested, err) || !read_what_it_tells(stage, against, c, err))
        return false;
    c->converged = info.converged;
    c->frame_ms = info.frame_ms;
    if (!renderer_read_ids(stage->renderer, c->ids))
        return error_set(err, ERROR_TRY_AGAIN, NULL, "the triangle ids could not be read back from the device");
    return true;
}

/* The other system sees the same ids: the camera pass does not depend on the system. */
static bool render_truth(struct stage *stage, const struct against *against, struct comparison *c, struct error *err)
{
    struct render_settings settings = stage->settings;
    struct frame_info info;
    settings.aa = 1;
    settings.format = PIXELS_RGBA8;
    settings.system = against->system;
    settings.params = against->params;
    void *pixels = stage_picture(&settings, err);
    bool good =
        pixels && stage_converge(stage, &settings, pixels, &info, NULL, err) && read_visibility(stage, &settings, c->truth, err);
    free(pixels);
    return good;
}

static bool measure(struct comparison *c, struct error *err)
{
    struct metrics_pool pool;
    bool good = true;
    metrics_pool_init(&pool);
    for (size_t i = 0; good && i < c->light_count; i++) {
        if (c->masks[i].receivers && c->truth_masks[i].receivers)
            c->wrong_samples[i] = metrics_wrong_samples(&c->masks[i], &c->truth_masks[i], (size_t)c->width * c->height);
        const struct metrics_input input = {
            .width = c->width,
            .height = c->height,
            .visibility = c->tested[i],
            .reference = c->truth[i],
            .receiver = c->receiver[i],
            .one_triangle = c->one_triangle,
            .wrong_samples = c->wrong_samples[i],
        };
        good = metrics_pool_add(&pool, &input, &c->light[i]);
    }
    metrics_pool_finish(&pool);
    c->total = pool.total;
    return good || error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for the error figures");
}

bool comparison_render(struct stage *stage, const struct against *against, struct comparison *out, struct error *err)
{
    return comparison_init(out, &stage->settings, err) && render_tested(stage, against, out, err) &&
           (against->kind != AGAINST_SYSTEM || render_truth(stage, against, out, err));
}

bool comparison_trace(const struct stage *stage, const struct against *against, const struct reference_progress *progress,
                      struct comparison *c, struct error *err)
{
    return truth_trace(stage, against, progress, c, err) && measure(c, err);
}

static void forget_tested(struct comparison *c)
{
    for (size_t i = 0; i < c->light_count; i++) {
        free(c->masks[i].receivers);
        free(c->masks[i].lit);
        c->masks[i] = (struct sample_masks){0};
        c->wrong_samples[i] = -1;
        list_reading_finish(&c->lists[i]);
        c->lists[i] = (struct list_reading){0};
    }
}

bool comparison_repeat(struct stage *stage, const struct against *against, struct comparison *c, struct error *err)
{
    forget_tested(c);
    /* They do not depend on the reference. */
    c->without_lists = against->kind != AGAINST_POINT;
    return render_tested(stage, against, c, err) && truth_count_lists(stage, c, err) && measure(c, err);
}
