/* The renderer's front: pictures from scenes. No sockets, no protocol, no hidden threads.
 *
 * A renderer and everything made from it belong to one thread, the one that created it (its GL context is current there).
 * Scenes are frozen and may be shared. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "gl/device.h"
#include "scene/scene.h"
#include "scene/view.h"
#include "shadow/shadow.h"

struct job_pool;
struct renderer;
struct render_scene;

enum camera_pass { CAMERA_PASS_AUTO, CAMERA_PASS_RASTER, CAMERA_PASS_TRACED };
enum resolve_pass { RESOLVE_PASS_AUTO, RESOLVE_PASS_GPU, RESOLVE_PASS_CPU };
enum show { SHOW_SHADED, SHOW_VISIBILITY, SHOW_DEPTH, SHOW_NORMAL, SHOW_ID };
enum tonemap { TONEMAP_ACES, TONEMAP_NONE };
enum pixel_format {
    PIXELS_RGBA8,   /* sRGB, tone mapped, alpha 255 */
    PIXELS_RGBA32F, /* linear, before tone mapping, alpha 1 */
};

#define RENDERER_LIGHTS_MAX 16
#define RENDERER_SIZE_MAX   16384 /* pixels a side */
#define RENDERER_IN_FLIGHT  3     /* frames submitted and not yet collected */

struct renderer_options {
    const char *device;     /* index in renderer_list_devices(), DRM node path, "software", or NULL: first that works */
    const char *shader_dir; /* read shaders from here and reload them when they change; NULL: the built-in ones */
    const char *cache_dir;  /* program binaries; NULL: $XDG_CACHE_HOME/gnomon or ~/.cache/gnomon; "": no cache */
    unsigned threads; /* >= 1; bounds the GL software rasterizer (LP_NUM_THREADS, set before the first context) and the tracer */
    bool gl_debug;    /* GL debug messages to the log */
};

/* Errors: ERROR_NO_DEVICE naming each attempt and why it failed. `pool` must outlive the renderer. */
struct renderer *renderer_create(const struct renderer_options *options, struct job_pool *pool, struct error *err);
void renderer_destroy(struct renderer *r); /* accepts NULL; every render_scene must be gone */

/* Every device that EGL offers, tried (gl/device.h); returns how many were written to `out` (at most `max`). Needs no renderer. */
size_t renderer_list_devices(struct device_info *out, size_t max);
/* The device in use. */
const struct device_info *renderer_device(const struct renderer *r);

/* Uploads `scene`, which must outlive the result. Destroy with render_scene_destroy() (accepts NULL). */
struct render_scene *render_scene_create(struct renderer *r, const struct scene *scene, struct error *err);
void render_scene_destroy(struct render_scene *s);

struct render_settings {
    uint32_t width, height;                   /* pixels of the result, 1..RENDERER_SIZE_MAX */
    struct camera camera;                     /* scene space */
    struct light lights[RENDERER_LIGHTS_MAX]; /* scene space */
    size_t light_count;
    const struct shadow_system *system;
    struct shadow_params params;
    enum show show;
    bool exposure_auto; /* from the lights and the scene's size alone */
    double exposure_ev; /* picture = radiance * 2^ev, when not auto */
    double ambient;     /* fraction of white ambient radiance, >= 0 */
    enum tonemap tonemap;
    unsigned aa; /* samples a pixel: 1, 4 or 16 */
    enum camera_pass camera_pass;
    enum camera_pass map_pass; /* the same choice for depth maps from lights */
    enum resolve_pass
        resolve_pass; /* where comparisons with depth maps and lighting are done; auto: on the CPU where the device is one */
    enum pixel_format format;
    uint32_t viewer;       /* whose picture: a light that moves takes along what was built for it, but only from its own viewer */
    size_t memory;         /* bytes that the lights' structures may take together; 0: no limit */
    bool finish_each_pass; /* waits after each pass so that pass times are true on any device */
};

struct render_settings render_settings_default(const struct scene *scene);

enum render_pass { PASS_CAMERA, PASS_RECEIVERS, PASS_PREPARE, PASS_RESOLVE, PASS_LIGHTING, PASS_READBACK, PASS_COUNT };
extern const char *const render_pass_names[PASS_COUNT]; /* "camera", ... */

struct frame_info {
    uint64_t token; /* as given to renderer_submit() */
    uint32_t width, height;
    enum pixel_format format;
    double pass_ms[PASS_COUNT]; /* wall times with finish_each_pass, else GPU timer queries (0 where those are not in yet) */
    double frame_ms;            /* from renderer_submit() to the pixels in CPU memory */
    bool prepared;              /* some light's shadow structure was rebuilt */
    bool traced_camera;         /* which producer made the ids */
    size_t shadow_bytes;        /* over all lights */
    unsigned map_count;         /* maps of the first light, 0 if none */
    uint32_t map_size;
    double map_fov_deg[SHADOW_MAPS_MAX];
    size_t map_count_total; /* over all lights */
    bool converged;         /* another frame of the same still view would change nothing */
    size_t figure_count;    /* of the first light's system, 0 if it tells none */
    struct shadow_figure figures[SHADOW_FIGURES_MAX];
};

/* Starts a frame; does not wait for the GPU. At most RENDERER_IN_FLIGHT may be uncollected (ERROR_TRY_AGAIN past that).
 * `token` comes back with the frame. */
bool renderer_submit(struct renderer *r, struct render_scene *s, const struct render_settings *settings, uint64_t token,
                     struct error *err);

/* The oldest frame in flight: copies its pixels (rows top to bottom, tightly packed) to `pixels`. With wait = false returns
 * false at once when the GPU is not done. False too when nothing is in flight, or (err set) the device was lost. */
bool renderer_collect(struct renderer *r, bool wait, void *pixels, size_t size, struct frame_info *info, struct error *err);

/* Size in pixels of the oldest frame in flight; false when none. */
bool renderer_oldest(const struct renderer *r, uint32_t *width, uint32_t *height, enum pixel_format *format);

/* Of the last frame submitted (aa = 1), waiting for it: visibility of `light`, one float a pixel, and the drawn-triangle ids
 * (SCENE_NONE: background) that the camera pass wrote. `out`: width * height. */
bool renderer_read_visibility(struct renderer *r, unsigned light, float *out);
bool renderer_read_ids(struct renderer *r, uint32_t *out);

/* What the system tells of that frame beyond visibility (shadow/shadow.h); `s` is the frame's scene. False with err untouched where it
 * has no such thing to tell. */
size_t renderer_read_figures(const struct render_scene *s, unsigned light, struct shadow_figure out[SHADOW_FIGURES_MAX]);
/* The masks behind the visibility: width * height each. */
bool renderer_read_masks(struct render_scene *s, unsigned light, uint32_t *receivers, uint32_t *lit, struct error *err);
/* The lists of triangles; both arrays become the caller's. *fit: what the maps see; its casters stand until the next frame. */
bool renderer_read_lists(struct render_scene *s, unsigned light, struct shadow_lists *out, struct shadow_fit *fit,
                         struct error *err);

/* Light `index` turned by `degrees` about the vertical axis through the scene's centre: --moving. */
struct light light_turned(const struct scene *scene, const struct light *light, double degrees);
/* The camera likewise: it goes round the scene and looks at what it looked at. */
struct camera camera_turned(const struct scene *scene, const struct camera *camera, double degrees);
