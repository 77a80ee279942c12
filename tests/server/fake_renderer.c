#include "fake_renderer.h"

#include <assert.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clock.h"
#include "renderer.h"

struct fake_renderer fake;

struct flight {
    struct render_settings settings;
    uint64_t token, started_us;
};

struct renderer {
    pthread_t owner;
    struct device_info device;
    struct flight flights[RENDERER_IN_FLIGHT];
    unsigned count;
    struct render_settings last;
};

struct render_scene {
    const struct scene *scene;
};

const char *const render_pass_names[PASS_COUNT] = {"camera", "receivers", "prepare", "resolve", "lighting", "readback"};

static void check_thread(const struct renderer *r) { assert(pthread_equal(r->owner, pthread_self())); }

struct renderer *renderer_create(const struct renderer_options *options, struct job_pool *pool, struct error *err)
{
    (void)pool;
    if (options->device && strcmp(options->device, "none") == 0) {
        error_set(err, ERROR_NO_DEVICE, "device", "there is no device here");
        return NULL;
    }
    struct renderer *r = calloc(1, sizeof *r);
    assert(r);
    r->owner = pthread_self();
    strcpy(r->device.renderer, "fake");
    return r;
}

void renderer_destroy(struct renderer *r)
{
    if (!r)
        return;
    check_thread(r);
    assert(atomic_load(&fake.scenes) == 0);
    free(r);
}

size_t renderer_list_devices(struct device_info *out, size_t max)
{
    (void)out, (void)max;
    return 0;
}

const struct device_info *renderer_device(const struct renderer *r) { return &r->device; }

struct render_scene *render_scene_create(struct renderer *r, const struct scene *scene, struct error *err)
{
    check_thread(r);
    if (atomic_load(&fake.fail_scene)) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "the device has no memory left");
        return NULL;
    }
    struct render_scene *s = malloc(sizeof *s);
    assert(s);
    s->scene = scene;
    atomic_fetch_add(&fake.scenes, 1);
    return s;
}

void render_scene_destroy(struct render_scene *s)
{
    if (s)
        atomic_fetch_sub(&fake.scenes, 1);
    free(s);
}

struct render_settings render_settings_default(const struct scene *scene)
{
    struct render_settings s = {
        .width = 64, .height = 48, .camera = scene_default_camera(scene, 4.0 / 3), .system = shadow_systems[0], .aa = 1};
    s.params = shadow_defaults(s.system);
    return s;
}

bool renderer_submit(struct renderer *r, struct render_scene *s, const struct render_settings *settings, uint64_t token,
                     struct error *err)
{
    check_thread(r);
    assert(s && r->count < RENDERER_IN_FLIGHT);
    if (atomic_load(&fake.fail_submit))
        return error_set(err, ERROR_BUG, NULL, "this frame cannot be made");
    r->last = *settings;
    r->flights[r->count++] = (struct flight){*settings, token, clock_us()};
    atomic_fetch_add(&fake.submitted, 1);
    return true;
}

static void paint(const struct render_settings *s, uint8_t *out)
{
    size_t bytes = s->format == PIXELS_RGBA32F ? 16 : 4;
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++, out += bytes) {
            uint8_t rgba[4] = {(uint8_t)(x * 4), (uint8_t)(y * 4), (uint8_t)(s->camera.eye.x * 10), 255};
            for (size_t i = 0; i < bytes; i++)
                out[i] = bytes == 4 ? rgba[i] : 0;
        }
}

bool renderer_collect(struct renderer *r, bool wait, void *pixels, size_t size, struct frame_info *info, struct error *err)
{
    check_thread(r);
    if (atomic_load(&fake.lose))
        return error_set(err, ERROR_TRY_AGAIN, NULL, "the device is lost");
    if (r->count == 0)
        return false;
    const struct flight *f = &r->flights[0];
    while (clock_us() - f->started_us < atomic_load(&fake.delay_us)) {
        if (!wait)
            return false;
        usleep(100);
    }
    assert(size == (size_t)f->settings.width * f->settings.height * (f->settings.format == PIXELS_RGBA32F ? 16 : 4));
    paint(&f->settings, pixels);
    *info = (struct frame_info){.token = f->token,
                                .width = f->settings.width,
                                .height = f->settings.height,
                                .format = f->settings.format,
                                .converged = atomic_load(&fake.submitted) >= atomic_load(&fake.rounds),
                                .frame_ms = (double)(clock_us() - f->started_us) / 1000};
    memmove(&r->flights[0], &r->flights[1], --r->count * sizeof r->flights[0]);
    atomic_fetch_add(&fake.collected, 1);
    return true;
}

bool renderer_oldest(const struct renderer *r, uint32_t *width, uint32_t *height, enum pixel_format *format)
{
    if (r->count == 0)
        return false;
    *width = r->flights[0].settings.width;
    *height = r->flights[0].settings.height;
    *format = r->flights[0].settings.format;
    return true;
}

/* Everything lit, nothing but background. */
bool renderer_read_visibility(struct renderer *r, unsigned light, float *out)
{
    (void)light;
    check_thread(r);
    for (size_t i = 0; i < (size_t)r->last.width * r->last.height; i++)
        out[i] = 1;
    return true;
}

bool renderer_read_ids(struct renderer *r, uint32_t *out)
{
    check_thread(r);
    for (size_t i = 0; i < (size_t)r->last.width * r->last.height; i++)
        out[i] = SCENE_NONE;
    return true;
}

size_t renderer_read_figures(const struct render_scene *s, unsigned light, struct shadow_figure out[SHADOW_FIGURES_MAX])
{
    (void)s, (void)light, (void)out;
    return 0;
}

bool renderer_read_masks(struct render_scene *s, unsigned light, uint32_t *receivers, uint32_t *lit, struct error *err)
{
    (void)s, (void)light, (void)receivers, (void)lit, (void)err;
    return false;
}

bool renderer_read_lists(struct render_scene *s, unsigned light, struct shadow_lists *out, struct shadow_fit *fit,
                         struct error *err)
{
    (void)s, (void)light, (void)out, (void)fit, (void)err;
    return false;
}

struct light light_turned(const struct scene *scene, const struct light *light, double degrees)
{
    (void)scene, (void)degrees;
    return *light;
}

struct camera camera_turned(const struct scene *scene, const struct camera *camera, double degrees)
{
    (void)scene, (void)degrees;
    return *camera;
}
