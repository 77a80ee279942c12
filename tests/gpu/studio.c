#include "studio.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/job_pool.h"
#include "reference/reference.h"

/* A progressive system that is not done by then will never be. */
#define FRAMES_MAX 2000

bool studio_open(struct studio *studio, const char *shader_dir, const char *cache_dir)
{
    struct error err = {0};
    const struct renderer_options options = {.threads = 2, .shader_dir = shader_dir, .cache_dir = cache_dir ? cache_dir : ""};
    *studio = (struct studio){.pool = job_pool_create(2, &err)};
    if (studio->pool)
        studio->renderer = renderer_create(&options, studio->pool, &err);
    if (studio->renderer)
        return true;
    fprintf(stderr, "skipped: %s\n", err.message);
    job_pool_destroy(studio->pool);
    return false;
}

void studio_close(struct studio *studio)
{
    renderer_destroy(studio->renderer);
    job_pool_destroy(studio->pool);
}

struct set set_build(struct studio *studio, struct scene *scene)
{
    struct error err = {0};
    struct set set = {.scene = scene, .uploaded = render_scene_create(studio->renderer, scene, &err)};
    if (!set.uploaded)
        fail_msg("%s: %s", scene->name, err.message);
    set.settings = render_settings_default(scene);
    set.settings.width = 96;
    set.settings.height = 64;
    set.settings.camera_pass = set.settings.map_pass = CAMERA_PASS_RASTER;
    return set;
}

struct set set_load(struct studio *studio, const char *name)
{
    struct error err = {0};
    struct scene *scene = scene_load(name, &err);
    if (!scene)
        fail_msg("%s: %s", name, err.message);
    return set_build(studio, scene);
}

void set_strike(struct set *set)
{
    render_scene_destroy(set->uploaded);
    scene_destroy(set->scene);
    memset(set, 0, sizeof *set);
}

void set_use(struct set *set, const char *algorithm)
{
    struct error err = {0};
    if (!shadow_parse(algorithm, &set->settings.system, &set->settings.params, &err))
        fail_msg("%s", err.message);
}

static void *room(size_t count, size_t size)
{
    void *data = calloc(count, size);
    if (!data)
        abort();
    return data;
}

struct shot shot_take(struct studio *studio, struct set *set)
{
    const struct render_settings *s = &set->settings;
    struct error err = {0};
    size_t pixels = (size_t)s->width * s->height;
    struct shot shot = {.width = s->width,
                        .height = s->height,
                        .light_count = s->light_count,
                        .size = pixels * (s->format == PIXELS_RGBA32F ? 16 : 4)};
    shot.pixels = room(shot.size, 1);
    bool prepared = false;
    for (int frame = 0; frame == 0 || !shot.info.converged; frame++) {
        if (frame == FRAMES_MAX)
            fail_msg("%s, %s: not converged after %d frames", set->scene->name, s->system->name, frame);
        if (!renderer_submit(studio->renderer, set->uploaded, s, 7, &err) ||
            !renderer_collect(studio->renderer, true, shot.pixels, shot.size, &shot.info, &err))
            fail_msg("%s: %s", set->scene->name, err.message);
        prepared |= shot.info.prepared;
    }
    shot.info.prepared = prepared;
    if (s->aa != 1)
        return shot;
    shot.ids = room(pixels, sizeof *shot.ids);
    assert_true(renderer_read_ids(studio->renderer, shot.ids));
    for (unsigned i = 0; i < s->light_count; i++) {
        shot.visibility[i] = room(pixels, sizeof(float));
        assert_true(renderer_read_visibility(studio->renderer, i, shot.visibility[i]));
    }
    return shot;
}

void shot_drop(struct shot *shot)
{
    free(shot->pixels);
    free(shot->ids);
    for (size_t i = 0; i < RENDERER_LIGHTS_MAX; i++)
        free(shot->visibility[i]);
    memset(shot, 0, sizeof *shot);
}

bool shot_same(const struct shot *a, const struct shot *b)
{
    size_t pixels = (size_t)a->width * a->height;
    if (a->size != b->size || a->light_count != b->light_count || memcmp(a->pixels, b->pixels, a->size) != 0)
        return false;
    if (a->ids && memcmp(a->ids, b->ids, pixels * sizeof *a->ids) != 0)
        return false;
    for (size_t i = 0; a->ids && i < a->light_count; i++)
        if (memcmp(a->visibility[i], b->visibility[i], pixels * sizeof(float)) != 0)
            return false;
    return true;
}

void shot_truth(const struct studio *studio, const struct set *set, const struct shot *shot, unsigned light, float **visibility,
                uint8_t **receiver)
{
    struct error err = {0};
    struct view view = view_from_camera(&set->settings.camera, shot->width, shot->height);
    struct reference *reference = reference_create(set->scene, 2, &err);
    if (!reference)
        fail_msg("%s: %s", set->scene->name, err.message);
    *visibility = room((size_t)shot->width * shot->height, sizeof **visibility);
    *receiver = room((size_t)shot->width * shot->height, 1);
    assert_true(reference_point(reference, &view, &set->settings.lights[light], shot->ids, studio->pool, NULL, *visibility,
                                *receiver, NULL));
    reference_destroy(reference);
}
