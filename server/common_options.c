#include "common_options.h"

#include <assert.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "lights.h"
#include "numbers.h"

const char *const show_names[] = {
    [SHOW_SHADED] = "shaded", [SHOW_VISIBILITY] = "visibility",
    [SHOW_DEPTH] = "depth",   [SHOW_NORMAL] = "normal",
    [SHOW_ID] = "id",         NULL,
};
const char *const tonemap_names[] = {[TONEMAP_ACES] = "aces", [TONEMAP_NONE] = "none", NULL};
const char *const camera_pass_names[] = {
    [CAMERA_PASS_AUTO] = "auto", [CAMERA_PASS_RASTER] = "raster", [CAMERA_PASS_TRACED] = "traced", NULL};

static const double EXPOSURE_LIMIT_EV = 64;
static const double AMBIENT_MAX = 1e6;

static bool set_size(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    return number_parse_size(value, RENDERER_SIZE_MAX, &o->width, &o->height, err);
}

static bool set_camera(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    if (!*value)
        return error_set(err, ERROR_USAGE, "camera", "a name, an index or auto is accepted");
    o->camera_named = true;
    o->camera.source = CAMERA_NAMED;
    o->camera.name = value;
    return true;
}

static bool set_eye(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    o->eye_given = true;
    return number_parse_point(value, &o->camera.eye, err);
}

static bool set_target(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    o->target_given = true;
    return number_parse_point(value, &o->camera.target, err);
}

static bool set_up(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    o->up_given = true;
    return number_parse_point(value, &o->camera.up, err);
}

static bool set_fov(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    o->fov_given = true;
    if (number_parse(value, FOV_MIN_DEG, FOV_MAX_DEG, &o->camera.fov_deg))
        return true;
    return error_set(err, ERROR_USAGE, "fov", "%g to %g degrees are accepted", FOV_MIN_DEG, FOV_MAX_DEG);
}

static bool set_ortho(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    o->ortho_given = true;
    if (number_parse(value, ORTHO_MIN, ORTHO_MAX, &o->camera.height))
        return true;
    return error_set(err, ERROR_USAGE, "ortho", "%g to %g scene units are accepted", ORTHO_MIN, ORTHO_MAX);
}

static bool set_light(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    if (o->light_count == RENDERER_LIGHTS_MAX)
        return error_set(err, ERROR_USAGE, "light", "at most %d lights are accepted", RENDERER_LIGHTS_MAX);
    if (!light_parse(value, &o->lights[o->light_count], err))
        return false;
    o->light_texts[o->light_count] = value;
    o->light_count++;
    return true;
}

static bool set_algorithm(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    return shadow_parse(value, &o->system, &o->params, err);
}

/* Sets *out to the index of `value` in `names`. */
static bool choose(const char *field, const char *const *names, const char *value, int *out, struct error *err)
{
    char list[160];
    *out = name_index(names, value);
    if (*out >= 0)
        return true;
    name_list(names, list, sizeof list);
    return error_set(err, ERROR_USAGE, field, "%s are accepted", list);
}

static bool set_show(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    int index;
    o->difference = !strcmp(value, "difference");
    if (o->difference)
        return true;
    index = name_index(show_names, value);
    if (index < 0)
        return error_set(err, ERROR_USAGE, "show", "shaded, visibility, depth, normal, id or difference are accepted");
    o->show = (enum show)index;
    return true;
}

static bool set_exposure(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    o->exposure_auto = !strcmp(value, "auto");
    if (o->exposure_auto || number_parse(value, -EXPOSURE_LIMIT_EV, EXPOSURE_LIMIT_EV, &o->exposure_ev))
        return true;
    return error_set(err, ERROR_USAGE, "exposure", "auto or %g to %g stops are accepted", -EXPOSURE_LIMIT_EV, EXPOSURE_LIMIT_EV);
}

static bool set_ambient(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    if (number_parse(value, 0, AMBIENT_MAX, &o->ambient))
        return true;
    return error_set(err, ERROR_USAGE, "ambient", "0 to %g is accepted", AMBIENT_MAX);
}

static bool set_tonemap(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    int index;
    if (!choose("tonemap", tonemap_names, value, &index, err))
        return false;
    o->tonemap = (enum tonemap)index;
    return true;
}

static bool set_aa(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    unsigned long n;
    if (!number_parse_unsigned(value, 1, 16, &n) || (n != 1 && n != 4 && n != 16))
        return error_set(err, ERROR_USAGE, "aa", "1, 4 or 16 samples a pixel are accepted");
    o->aa = (unsigned)n;
    return true;
}

static bool set_camera_pass(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    int index;
    if (!choose("camera-pass", camera_pass_names, value, &index, err))
        return false;
    o->camera_pass = (enum camera_pass)index;
    return true;
}

static bool set_frames_timed(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    unsigned long n;
    if (!number_parse_unsigned(value, 1, FRAMES_TIMED_MAX, &n))
        return error_set(err, ERROR_USAGE, "frames-timed", "1 to %d frames are accepted", FRAMES_TIMED_MAX);
    o->frames_timed = (unsigned)n;
    return true;
}

static bool set_moving(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    (void)value, (void)err;
    o->moving = true;
    return true;
}

static bool set_threads(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    unsigned long n;
    if (!number_parse_unsigned(value, 1, THREADS_MAX, &n))
        return error_set(err, ERROR_USAGE, "threads", "1 to %d threads are accepted", THREADS_MAX);
    o->threads = (unsigned)n;
    return true;
}

static bool set_device(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    if (!*value)
        return error_set(err, ERROR_USAGE, "device",
                         "an index of gnomon list devices, a DRM node path, cuda:N or software is accepted");
    o->device = value;
    return true;
}

static bool set_memory(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    unsigned long n;
    if (!number_parse_unsigned(value, 1, MEMORY_MAX_MIB, &n))
        return error_set(err, ERROR_USAGE, "memory", "1 to %d MiB are accepted", MEMORY_MAX_MIB);
    o->memory = (size_t)n << 20;
    return true;
}

static bool set_shader_dir(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    if (!*value)
        return error_set(err, ERROR_USAGE, "shader-dir", "a folder is accepted");
    o->shader_dir = value;
    return true;
}

static bool set_quiet(void *target, const char *value, struct error *err)
{
    struct common_options *o = target;
    (void)value, (void)err;
    o->quiet = true;
    return true;
}

/* The log's level is the process's, so it takes effect at once. */
static bool set_log_level(void *target, const char *value, struct error *err)
{
    static const char *const names[] = {"error", "warning", "info", "debug", NULL};
    int index;
    (void)target;
    if (!choose("log-level", names, value, &index, err))
        return false;
    log_set_level((enum log_level)index);
    return true;
}

const struct option common_option_table[] = {
    {"size", "WxH", "picture size in pixels, each 1 to 16384 (default 1280x720)", set_size},
    {"camera", "NAME|INDEX|auto", "one of the scene's cameras, or one that frames the scene (default: the first, else auto)",
     set_camera},
    {"eye", "x,y,z", "look from here, with --target; world coordinates", set_eye},
    {"target", "x,y,z", "look at this point, with --eye", set_target},
    {"up", "x,y,z", "what is up, with --eye (default 0,1,0)", set_up},
    {"fov", "DEG", "full vertical angle, with --eye (default 45)", set_fov},
    {"ortho", "HEIGHT", "orthographic, with --eye: as many scene units from bottom to top, in place of --fov", set_ortho},
    {"light", "'KIND key=value ...'",
     "KIND point, spot or directional; repeat for more; replaces the scene's lights (keys below)", set_light},
    {"algorithm", "NAME[:key=value,...]", "shadow system and its parameters; gnomon list algorithms prints them", set_algorithm},
    {"show", "WHAT",
     "shaded, visibility, depth, normal, id or difference (default shaded); difference: render only, against point", set_show},
    {"exposure", "EV|auto", "stops, or from the scene's lights and size alone (default auto)", set_exposure},
    {"ambient", "X", "white light from everywhere (default 0.03)", set_ambient},
    {"tonemap", "aces|none", "tone mapping of PNG, JPEG and WebP (default aces)", set_tonemap},
    {"aa", "1|4|16", "samples a pixel (default 1)", set_aa},
    {"time", "SECONDS", "moment of the scene's animation", NULL},
    {"camera-pass", "auto|raster|traced", "how visible triangles are found (default: the faster on this device)",
     set_camera_pass},
    {"frames-timed", "N", "frames to time, after 3 untimed ones (default for --stats: 20, fewer where they are slow)",
     set_frames_timed},
    {"moving", NULL, "turn the lights by 0.25 degrees for each timed frame", set_moving},
    {"threads", "N", "bounds all work (default SLURM_CPUS_PER_TASK, else the cores allowed)", set_threads},
    {"device", "INDEX|NODE|software", "gnomon list devices prints them; cuda:N is taken too (default: the first that works)",
     set_device},
    {"memory", "MIB", "what the lights' shadow structures may take together, 1 to 1048576 (default: no limit)", set_memory},
    {"shader-dir", "DIR", "read the shaders from DIR, again whenever they change", set_shader_dir},
    {"quiet", NULL, "no progress bar", set_quiet},
    {"log-level", "LEVEL", "error, warning, info or debug, on standard error (default warning)", set_log_level},
    {0},
};

static_assert(sizeof common_option_table / sizeof common_option_table[0] <= COMMON_OPTIONS_MAX,
              "struct common_options has room for each");

void common_options_note(struct common_options *options, const struct option *option, const char *value)
{
    options->given[option - common_option_table] = value ? value : "";
}

const char *common_options_given(const struct common_options *options, const char *name)
{
    for (size_t i = 0; common_option_table[i].name; i++)
        if (strcmp(common_option_table[i].name, name) == 0)
            return options->given[i];
    return NULL;
}

unsigned threads_allowed(void)
{
    const char *slurm = getenv("SLURM_CPUS_PER_TASK");
    unsigned long n;
    if (slurm && number_parse_unsigned(slurm, 1, THREADS_MAX, &n))
        return (unsigned)n;
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0)
        return 1;
    int cores = CPU_COUNT(&set);
    return cores < 1 ? 1 : cores > THREADS_MAX ? THREADS_MAX : (unsigned)cores;
}

void common_options_init(struct common_options *options)
{
    *options = (struct common_options){
        .width = 1280,
        .height = 720,
        .camera = camera_choice_default(),
        .exposure_auto = true,
        .ambient = 0.03,
        .tonemap = TONEMAP_ACES,
        .aa = 1,
        .camera_pass = CAMERA_PASS_AUTO,
        .threads = threads_allowed(),
    };
}

bool common_options_check(struct common_options *o, struct error *err)
{
    if (o->eye_given != o->target_given)
        return error_set(err, ERROR_USAGE, o->eye_given ? "target" : "eye",
                         "--eye and --target belong together: give both, or --camera");
    if (o->eye_given && o->camera_named)
        return error_set(err, ERROR_USAGE, "camera", "--camera and --eye exclude each other: give one of them");
    if ((o->up_given || o->fov_given) && !o->eye_given)
        return error_set(err, ERROR_USAGE, o->up_given ? "up" : "fov", "%s is accepted only with --eye and --target",
                         o->up_given ? "--up" : "--fov");
    if (o->ortho_given && (o->fov_given || !o->eye_given))
        return error_set(err, ERROR_USAGE, "ortho", "--ortho is accepted only with --eye and --target, and without --fov");
    if (!o->eye_given)
        return true;
    o->camera.source = CAMERA_LOOK_AT;
    return camera_check_look_at(&o->camera, err);
}

bool common_options_settings(const struct common_options *o, const struct scene *scene, struct render_settings *out,
                             struct error *err)
{
    *out = render_settings_default(scene);
    out->width = o->width;
    out->height = o->height;
    if (!camera_choose(scene, &o->camera, (double)o->width / o->height, &out->camera, err))
        return false;
    if (o->light_count) {
        out->light_count = o->light_count;
        for (size_t i = 0; i < o->light_count; i++)
            out->lights[i] = light_from_world(scene, &o->lights[i]);
    } else if (scene->light_count > RENDERER_LIGHTS_MAX) {
        log_warning("the scene has %zu lights; the first %d are used", scene->light_count, RENDERER_LIGHTS_MAX);
    }
    if (o->system) {
        out->system = o->system;
        out->params = o->params;
    }
    out->show = o->show;
    out->exposure_auto = o->exposure_auto;
    out->exposure_ev = o->exposure_ev;
    out->ambient = o->ambient;
    out->tonemap = o->tonemap;
    out->aa = o->aa;
    out->camera_pass = o->camera_pass;
    out->memory = o->memory;
    return true;
}

struct renderer_options common_options_renderer(const struct common_options *o)
{
    return (struct renderer_options){
        .device = o->device,
        .shader_dir = o->shader_dir,
        .threads = o->threads,
        .gl_debug = log_get_level() == LOG_DEBUG,
    };
}
