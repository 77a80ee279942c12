#include "renderer.h"

#include <assert.h>
#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "frame.h"
#include "gl/program.h"
#include "render_scene.h"

#define RELOAD_EVERY_MS 250

const char *const render_pass_names[PASS_COUNT] = {"camera", "receivers", "prepare", "resolve", "lighting", "readback"};

size_t renderer_list_devices(struct device_info *out, size_t max) { return gl_device_list(out, max); }

const struct device_info *renderer_device(const struct renderer *r) { return &r->gl.device; }

/* XDG Base Directory Specification. False: no home, so no cache. */
static bool default_cache(char *out, size_t size)
{
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (cache && cache[0] == '/')
        return snprintf(out, size, "%s/gnomon", cache) < (int)size;
    return home && home[0] == '/' && snprintf(out, size, "%s/.cache/gnomon", home) < (int)size;
}

struct renderer *renderer_create(const struct renderer_options *options, struct job_pool *pool, struct error *err)
{
    struct renderer *r = calloc(1, sizeof *r);
    if (!r) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the renderer");
        return NULL;
    }
    r->pool = pool;
    r->threads = options->threads;
    struct gl_context_options context = {options->device, options->threads, options->gl_debug};
    if (!gl_context_init(&r->gl, &context, err)) {
        free(r);
        return NULL;
    }
    char path[512];
    const char *cache = options->cache_dir ? options->cache_dir : default_cache(path, sizeof path) ? path : "";
    r->programs = gl_programs_create(&r->gl, options->shader_dir, cache[0] ? cache : NULL, err);
    if (!r->programs) {
        gl_context_finish(&r->gl);
        free(r);
        return NULL;
    }
    gl_timer_init(&r->timer);
    return r;
}

void renderer_destroy(struct renderer *r)
{
    if (!r)
        return;
    lighting_finish(&r->lighting);
    gl_buffer_finish(&r->light_block);
    gl_buffer_finish(&r->params_block);
    visibility_finish(&r->visibility);
    gbuffer_finish(&r->gbuffer);
    gl_readback_finish(&r->readback);
    gl_timer_finish(&r->timer);
    gl_programs_destroy(r->programs);
    gl_context_finish(&r->gl);
    free(r);
}

struct render_settings render_settings_default(const struct scene *scene)
{
    struct render_settings s = {
        .width = 1280,
        .height = 720,
        .system = shadow_default(),
        .exposure_auto = true,
        .ambient = 0.03,
        .aa = 1,
    };
    s.params = shadow_defaults(s.system);
    s.camera = scene->camera_count ? scene->cameras[0] : scene_default_camera(scene, (double)s.width / s.height);
    s.light_count = scene->light_count < RENDERER_LIGHTS_MAX ? scene->light_count : RENDERER_LIGHTS_MAX;
    if (s.light_count)
        memcpy(s.lights, scene->lights, s.light_count * sizeof s.lights[0]);
    else
        s.lights[s.light_count++] = scene_default_light(scene);
    return s;
}

static bool check_settings(const struct render_settings *s, struct error *err)
{
    unsigned side = s->aa == 16 ? 4 : s->aa == 4 ? 2 : 1, limit = RENDERER_SIZE_MAX / side;
    if (s->width < 1 || s->height < 1 || s->width > limit || s->height > limit)
        return error_set(err, ERROR_USAGE, "size", "a picture of %u x %u with %u samples a pixel is not possible: 1 to %u a side",
                         s->width, s->height, s->aa, limit);
    for (size_t i = 0; i < s->light_count; i++)
        if (!(s->system->lights & 1u << s->lights[i].kind))
            return error_set(err, ERROR_USAGE, "algorithm", "%s casts no shadows from this kind of light", s->system->name);
    return true;
}

static void reload_shaders(struct renderer *r, struct render_scene *s)
{
    double now = clock_ms();
    if (now - r->reload_checked_ms < RELOAD_EVERY_MS)
        return;
    r->reload_checked_ms = now;
    if (gl_programs_reload(r->programs))
        light_states_invalidate(&s->states);
}

static bool start_readback(struct renderer *r, const struct render_settings *settings, struct frame_info *info, struct error *err)
{
    bool wide = settings->format == PIXELS_RGBA32F;
    bool ok = gl_readback_start(&r->readback, &r->gl, settings->width, settings->height, GL_RGBA,
                                wide ? GL_FLOAT : GL_UNSIGNED_BYTE, wide ? 16 : 4, err);
    info->pass_ms[PASS_READBACK] = gl_timer_mark(&r->timer, PASS_READBACK);
    return ok;
}

bool renderer_submit(struct renderer *r, struct render_scene *s, const struct render_settings *settings, uint64_t token,
                     struct error *err)
{
    assert(s->renderer == r);
    if (r->count == RENDERER_IN_FLIGHT)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "%d frames are in flight already", RENDERER_IN_FLIGHT);
    if (!check_settings(settings, err))
        return false;
    reload_shaders(r, s);
    struct in_flight *f = &r->frames[(r->first + r->count) % RENDERER_IN_FLIGHT];
    memset(f, 0, sizeof *f);
    f->start_ms = clock_ms();
    f->finish_each_pass = settings->finish_each_pass;
    f->info.token = token;
    f->info.width = settings->width;
    f->info.height = settings->height;
    f->info.format = settings->format;
    for (unsigned i = 0; i < r->count; i++)
        r->frames[(r->first + i) % RENDERER_IN_FLIGHT].timer_age++;
    if (!frame_render(r, s, settings, &f->info, err) || !start_readback(r, settings, &f->info, err))
        return false;
    r->count++;
    return true;
}

bool renderer_collect(struct renderer *r, bool wait, void *pixels, size_t size, struct frame_info *info, struct error *err)
{
    if (r->count == 0)
        return false;
    struct in_flight *f = &r->frames[r->first];
    unsigned waiting = r->readback.count;
    double start = clock_ms();
    bool ok = gl_readback_finish_oldest(&r->readback, &r->gl, wait, pixels, size, err);
    if (r->readback.count < waiting) {
        r->first = (r->first + 1) % RENDERER_IN_FLIGHT;
        r->count--;
    }
    if (!ok)
        return false;
    double now = clock_ms();
    f->info.frame_ms = now - f->start_ms;
    if (f->finish_each_pass)
        f->info.pass_ms[PASS_READBACK] += now - start;
    else
        gl_timer_read(&r->timer, f->timer_age, f->info.pass_ms, PASS_COUNT);
    *info = f->info;
    return true;
}

bool renderer_oldest(const struct renderer *r, uint32_t *width, uint32_t *height, enum pixel_format *format)
{
    if (r->count == 0)
        return false;
    const struct frame_info *info = &r->frames[r->first].info;
    *width = info->width;
    *height = info->height;
    *format = info->format;
    return true;
}

/* Turns a direction about the vertical axis. */
static struct dvec3 turned(struct dvec3 v, double degrees)
{
    double s = sin(degrees * M_PI / 180), c = cos(degrees * M_PI / 180);
    return dvec3(c * v.x + s * v.z, v.y, c * v.z - s * v.x);
}

/* Turns a point about the vertical axis through the scene's centre. */
static struct dvec3 turned_about(const struct scene *scene, struct dvec3 p, double degrees)
{
    struct dvec3 centre = dbox_is_empty(&scene->bounds) ? dvec3(0, 0, 0) : dbox_center(&scene->bounds);
    return dvec3_add(centre, turned(dvec3_sub(p, centre), degrees));
}

struct light light_turned(const struct scene *scene, const struct light *light, double degrees)
{
    struct light result = *light;
    result.position = turned_about(scene, light->position, degrees);
    result.direction = turned(light->direction, degrees);
    return result;
}

struct camera camera_turned(const struct scene *scene, const struct camera *camera, double degrees)
{
    struct camera result = *camera;
    result.eye = turned_about(scene, camera->eye, degrees);
    result.right = turned(camera->right, degrees);
    result.up = turned(camera->up, degrees);
    result.back = turned(camera->back, degrees);
    return result;
}
