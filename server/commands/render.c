#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "command.h"
#include "common_options.h"
#include "comparison.h"
#include "difference.h"
#include "figures.h"
#include "frame_name.h"
#include "import/import.h"
#include "measure.h"
#include "numbers.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "remote_picture.h"
#include "stage.h"

struct render_options {
    struct common_options common;
    const char *output;
    enum image_format format;
    const char *stats;    /* NULL: none */
    unsigned progressive; /* frames; 0: until converged */
    struct remote remote;
};

static bool set_output(void *target, const char *value, struct error *err)
{
    struct render_options *o = target;
    o->output = value;
    if (!strcmp(value, "-")) {
        o->format = IMAGE_PNG;
        return true;
    }
    if (image_format_from_name(value, &o->format))
        return true;
    return error_set(err, ERROR_USAGE, "o", "has no known extension; .png, .jpg, .webp and .exr are accepted");
}

static bool set_stats(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct render_options *)target)->stats = value;
    return true;
}

enum { PROGRESSIVE_MAX = 100000 };

static bool set_progressive(void *target, const char *value, struct error *err)
{
    unsigned long n;
    if (!number_parse_unsigned(value, 1, PROGRESSIVE_MAX, &n))
        return error_set(err, ERROR_USAGE, "progressive", "1 to %d frames are accepted", PROGRESSIVE_MAX);
    ((struct render_options *)target)->progressive = (unsigned)n;
    return true;
}

static bool set_server(void *target, const char *value, struct error *err)
{
    return remote_set_url(&((struct render_options *)target)->remote, value, err);
}

static bool set_token_file(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct render_options *)target)->remote.token_file = value;
    return true;
}

static const struct option option_table[] = {
    {"o", "FILE", "the picture; .png, .jpg, .webp or .exr; - is standard output, as PNG", set_output},
    {"stats", "FILE", "times, memory and sizes as JSON; - is standard output", set_stats},
    {"progressive", "N", "render N frames of the still view and write the last, or, with #### in FILE, each", set_progressive},
    {"server", "URL", REMOTE_OPTION_URL, set_server},
    {"token-file", "FILE", REMOTE_OPTION_TOKEN, set_token_file},
    {0},
};

static const struct syntax syntax = {
    .command = "render",
    .usage = "SCENE -o FILE [--server URL] [options]",
    .summary = "Renders a scene to a picture: sRGB 8 bit for PNG, JPEG and WebP, linear float before tone mapping for EXR.",
    .operand = "SCENE",
    .common = true,
    .options = option_table,
    .notes =
        "Lights: position=x,y,z direction=x,y,z color=r,g,b intensity=X radius=X inner=DEG outer=DEG range=X; world coordinates,\n"
        "scene units, degrees, candela (point, spot) or lux (directional).\n\n"
        "Systems that refine their shadows from frame to frame are run until nothing changes any more (at most 512 frames; --stats says\n"
        "how many), then timed. With --progressive N exactly N frames are rendered, from the first on, and --stats has a row for each:\n"
        "its time, memory and what the system tells of itself.\n\n"
        "With --server, SCENE is a name as gnomon list scenes --server URL prints it, or builtin:NAME; the picture is the same, bit for bit.\n"
        "Options that are not given are then the server's own.\n\n"
        "--show difference paints the picture that gnomon compare --against point -o FILE writes.\n",
    .examples = "  gnomon render model.glb -o picture.png\n"
                "  gnomon render builtin:dragon -o dragon.exr --size 1920x1080 --algorithm sm:size=2048 --stats -\n"
                "  gnomon render model.glb -o 'refined.####.png' --progressive 30 --stats refined.json\n"
                "  gnomon render builtin:ball -o ball.png --server http://127.0.0.1:8080/\n"
                "  gnomon render model.glb -o top.jpg --eye 0,5,5 --target 0,0,0 --fov 35 \\\n"
                "      --light 'spot position=2,4,1 direction=-2,-4,-1 intensity=500 inner=10 outer=30'\n",
};

/* Text that a picture carries with it. */
struct stamp {
    char hash[20], camera[240], algorithm[300], device[130], milliseconds[32], scene[130];
    struct image_metadata entries[7];
};

enum { STAMP_ENTRIES = 7 };

static void describe_camera(const struct scene *scene, const struct camera *c, char *out, size_t size)
{
    struct dvec3 eye = dvec3_add(c->eye, scene->origin), forward = dvec3_sub(dvec3(0, 0, 0), c->back);
    snprintf(out, size, "eye=%.9g,%.9g,%.9g forward=%.9g,%.9g,%.9g up=%.9g,%.9g,%.9g %s=%.9g", eye.x, eye.y, eye.z, forward.x,
             forward.y, forward.z, c->up.x, c->up.y, c->up.z, c->orthographic ? "height" : "fov",
             c->orthographic ? 2 * c->ymag : c->yfov * (180 / M_PI));
}

static void stamp_fill(struct stamp *s, const struct stage *stage, double frame_ms)
{
    snprintf(s->scene, sizeof s->scene, "%s", stage->scene->name);
    snprintf(s->hash, sizeof s->hash, "%016" PRIx64, stage->scene->hash);
    describe_camera(stage->scene, &stage->settings.camera, s->camera, sizeof s->camera);
    shadow_format(stage->settings.system, &stage->settings.params, s->algorithm, sizeof s->algorithm);
    snprintf(s->device, sizeof s->device, "%s", renderer_device(stage->renderer)->renderer);
    snprintf(s->milliseconds, sizeof s->milliseconds, "%.3f", frame_ms);
    const struct image_metadata entries[STAMP_ENTRIES] = {
        {"Software", "gnomon " GNOMON_VERSION}, {"gnomon:scene", s->scene},         {"gnomon:scene_hash", s->hash},
        {"gnomon:camera", s->camera},           {"gnomon:algorithm", s->algorithm}, {"gnomon:device", s->device},
        {"gnomon:render_ms", s->milliseconds},
    };
    memcpy(s->entries, entries, sizeof entries);
}

enum { PICTURE_QUALITY = 90 }; /* JPEG and WebP */

static bool write_stamped(const struct render_options *o, const struct stage *stage, const char *path, const void *pixels,
                          double frame_ms, struct error *err)
{
    struct stamp stamp;
    stamp_fill(&stamp, stage, frame_ms);
    return image_write(path, o->format, pixels, stage->settings.width, stage->settings.height, PICTURE_QUALITY, stamp.entries,
                       STAMP_ENTRIES, err);
}

static bool write_picture(const struct render_options *o, struct stage *stage, double *frame_ms, struct error *err)
{
    struct frame_info info;
    struct progress progress;
    void *pixels = stage_picture(&stage->settings, err);
    progress_init(&progress, "rendering", o->common.quiet);
    bool good = pixels && stage_converge(stage, &stage->settings, pixels, &info, NULL, err);
    progress_finish(&progress);
    *frame_ms = info.frame_ms;
    good = good && write_stamped(o, stage, o->output, pixels, info.frame_ms, err);
    free(pixels);
    return good;
}

static bool report_progress(void *context, double done)
{
    progress_set(context, done);
    return true;
}

/* --show difference: what compare -o writes. */
static bool write_difference(const struct render_options *o, struct stage *stage, double *frame_ms, struct error *err)
{
    const struct against point = {.kind = AGAINST_POINT};
    struct comparison c = {0};
    struct progress progress;
    progress_init(&progress, "comparing", o->common.quiet);
    const struct reference_progress report = {report_progress, &progress};
    bool good = comparison_render(stage, &point, &c, err) && comparison_trace(stage, &point, &report, &c, err);
    progress_finish(&progress);
    good = good && difference_write(&c, stage, &point, o->output, o->format, err);
    *frame_ms = c.frame_ms;
    comparison_finish(&c);
    return good;
}

/* The frames of --progressive, as they come. */
struct sequence {
    const struct render_options *options;
    struct stage *stage;
    json_t *rows;
};

static bool take_frame(void *context, unsigned frame, const struct frame_info *info, const void *pixels, struct error *err)
{
    struct sequence *s = context;
    const struct render_options *o = s->options;
    char path[4096];
    json_array_append_new(s->rows, figures_frame(info));
    bool each = frame_name(o->output, frame + 1, path, sizeof path);
    return !(each || frame + 1 == o->progressive) ||
           write_stamped(o, s->stage, each ? path : o->output, pixels, info->frame_ms, err);
}

static bool render_progress(const struct render_options *o, struct stage *stage, struct error *err)
{
    struct sequence sequence = {o, stage, json_array()};
    const struct frame_sink sink = {take_frame, &sequence};
    struct measurement measured;
    struct progress progress;
    progress_init(&progress, "rendering", o->common.quiet);
    bool good = measure_progress(stage, o->progressive, &sink, &progress, &measured, err);
    progress_finish(&progress);
    if (good && o->stats) {
        json_t *figures = figures_render(stage->scene, &stage->settings, renderer_device(stage->renderer), &measured);
        json_object_set(figures, "progressive", sequence.rows);
        good = output_json(o->stats, figures, err);
    }
    json_decref(sequence.rows);
    return good;
}

/* Frames are timed when somebody will read the times, or asked for it. */
static bool write_stats(const struct render_options *o, struct stage *stage, double frame_ms, struct error *err)
{
    if (!o->stats && !o->common.frames_timed)
        return true;
    struct progress progress;
    struct measurement measured;
    unsigned frames = o->common.frames_timed ? o->common.frames_timed : measure_default_frames(frame_ms);
    progress_init(&progress, "timing", o->common.quiet);
    bool good = measure_frames(stage, frames, o->common.moving, &progress, &measured, err);
    progress_finish(&progress);
    if (!good)
        return false;
    if (!o->stats) {
        if (!o->common.quiet)
            fprintf(stderr, "%u frames: min %.2f ms, median %.2f ms, p95 %.2f ms\n", frames, measured.min_ms, measured.median_ms,
                    measured.p95_ms);
        return true;
    }
    return output_json(o->stats, figures_render(stage->scene, &stage->settings, renderer_device(stage->renderer), &measured),
                       err);
}

static bool check_outputs(const struct render_options *o, struct error *err)
{
    if (!o->output)
        return error_set(err, ERROR_USAGE, "o", "render needs -o FILE; .png, .jpg, .webp and .exr are accepted");
    if (o->stats && !strcmp(o->output, "-") && !strcmp(o->stats, "-"))
        return error_set(err, ERROR_USAGE, "stats", "-o - and --stats - exclude each other: standard output carries one thing");
    if (o->stats && o->remote.url)
        return error_set(
            err, ERROR_USAGE, "stats",
            "--stats and --server exclude each other: times and memory are measured where it renders; leave one out");
    if (o->progressive && o->remote.url)
        return error_set(err, ERROR_USAGE, "progressive",
                         "--progressive and --server exclude each other: a server answers with one picture; leave one out");
    if (o->remote.token_file && !o->remote.url)
        return error_set(err, ERROR_USAGE, "token-file", "--token-file is accepted only with --server");
    if (o->common.difference && (o->progressive || o->remote.url))
        return error_set(err, ERROR_USAGE, "show", "--show difference and %s exclude each other: give one of them",
                         o->progressive ? "--progressive" : "--server");
    return output_check(o->output, err) && (!o->stats || output_check(o->stats, err));
}

static bool render_remote(const struct render_options *o, const char *scene, struct error *err)
{
    struct remote_answer answer;
    if (!remote_picture(&o->remote, scene, &o->common, o->format, PICTURE_QUALITY, &answer, err))
        return false;
    bool good = image_write_bytes(o->output, answer.data, answer.size, err);
    free(answer.data);
    return good;
}

static bool render_here(const struct render_options *o, const char *scene, struct error *err)
{
    struct stage stage = {0};
    double frame_ms = 0;
    bool good = stage_init(&stage, scene, &o->common, err);
    if (good) {
        stage.settings.format = o->format == IMAGE_EXR ? PIXELS_RGBA32F : PIXELS_RGBA8;
        if (o->progressive)
            good = render_progress(o, &stage, err);
        else
            good =
                (o->common.difference ? write_difference(o, &stage, &frame_ms, err) : write_picture(o, &stage, &frame_ms, err)) &&
                write_stats(o, &stage, frame_ms, err);
    }
    stage_finish(&stage);
    return good;
}

int command_render(int argc, char **argv)
{
    struct render_options options = {0};
    struct error err = {0};
    const char *scene = NULL;
    common_options_init(&options.common);
    int code = options_start(&syntax, argc, argv, &options, &options.common, &scene);
    if (code >= 0)
        return code;
    bool good = check_outputs(&options, &err) &&
                (options.remote.url ? render_remote(&options, scene, &err) : render_here(&options, scene, &err));
    return good ? 0 : command_fail(&err);
}
