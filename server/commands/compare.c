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
#include "flicker_run.h"
#include "import/import.h"
#include "lights.h"
#include "measure.h"
#include "numbers.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "reference/oracle.h"
#include "stage.h"

struct compare_options {
    struct common_options common;
    struct against against;
    const char *picture; /* NULL: none */
    enum image_format format;
    const char *json; /* NULL: none */
    bool flicker[FLICKER_MOTIONS];
    unsigned flicker_frames; /* 0: the default */
    unsigned oracle; /* length of its lists; 0: not wanted */
};

static bool set_against(void *target, const char *value, struct error *err)
{
    return against_parse(value, &((struct compare_options *)target)->against, err);
}

static bool set_picture(void *target, const char *value, struct error *err)
{
    struct compare_options *o = target;
    o->picture = value;
    o->format = IMAGE_PNG;
    if (!strcmp(value, "-") || image_format_from_name(value, &o->format))
        return true;
    return error_set(err, ERROR_USAGE, "o", "has no known extension; .png, .jpg, .webp and .exr are accepted");
}

static bool set_json(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct compare_options *)target)->json = value;
    return true;
}

static bool set_flicker(void *target, const char *value, struct error *err)
{
    int motion = name_index(flicker_motion_names, value);
    if (motion < 0)
        return error_set(err, ERROR_USAGE, "flicker", "light or camera are accepted");
    ((struct compare_options *)target)->flicker[motion] = true;
    return true;
}

static bool set_frames(void *target, const char *value, struct error *err)
{
    unsigned long n;
    if (!number_parse_unsigned(value, FLICKER_FRAMES_MIN, FLICKER_FRAMES_MAX, &n))
        return error_set(err, ERROR_USAGE, "frames", "%d to %d frames are accepted", FLICKER_FRAMES_MIN, FLICKER_FRAMES_MAX);
    ((struct compare_options *)target)->flicker_frames = (unsigned)n;
    return true;
}

static bool set_oracle(void *target, const char *value, struct error *err)
{
    unsigned long n;
    if (!number_parse_unsigned(value, 1, ORACLE_LENGTH_MAX, &n))
        return error_set(err, ERROR_USAGE, "oracle", "lists of 1 to %d triangles are accepted", ORACLE_LENGTH_MAX);
    ((struct compare_options *)target)->oracle = (unsigned)n;
    return true;
}

static const struct option option_table[] = {
    {"against", "REF", "point, samples32, arealight[:radius=R,rays=N] or an algorithm (default point)", set_against},
    {"o", "DIFF", "picture of the differences; .png, .jpg, .webp or .exr; - is standard output, as PNG", set_picture},
    {"json", "FILE", "times, memory and error figures as JSON; - is standard output", set_json},
    {"flicker", "light|camera", "measure flicker too while these turn by 0.05 degrees a frame; may be given for both",
     set_flicker},
    {"oracle", "N", "systems with lists: also what lists of the N most visible triangles of each texel would get wrong",
     set_oracle},
    {"frames", "N", "frames of --flicker, 3 to 10000 (default 16)", set_frames},
    {0},
};

static const struct syntax syntax = {
    .command = "compare",
    .usage = "SCENE --algorithm A [--against REF] [-o DIFF.png] [--json FILE] [options]",
    .summary = "Measures how far a shadow system's visibility is from ray tracing's.",
    .operand = "SCENE",
    .common = true,
    .options = option_table,
    .notes =
        "References: point traces one ray for the triangle at each pixel centre; samples32 traces 32 samples a pixel;\n"
        "arealight sends N rays (default 256) from each pixel centre's receiver to a disc of radius R around the light (default: the\n"
        "light's radius, else 2 % of its distance from the scene's centre; for directional lights R is in degrees, default 0.5).\n\n"
        "The difference picture: grey, where right; orange, where too bright (light leaks); blue, where too dark (acne); stronger\n"
        "colour, larger difference; with several lights, the largest. As EXR: R = tested, G = reference, B = tested - reference,\n"
        "A = 1 where the pixel counts.\n\n"
        "Flicker: the mean of |V(t+1) - 2 V(t) + V(t-1)| over pixels that are receivers in all three frames, less the reference's own.\n\n"
        "Figures are measured at one sample a pixel; --aa, --moving and --frames-timed change only the times of --json.\n",
    .examples = "  gnomon compare builtin:dragon --algorithm sm:size=1024 -o difference.png\n"
                "  gnomon compare model.glb --algorithm pcf:kernel=7 --against samples32 --json -\n"
                "  gnomon compare model.glb --algorithm pcf --against sm:size=4096\n"
                "  gnomon compare builtin:tree --algorithm coverage --flicker light --flicker camera --frames 32 --json -\n"
                "  gnomon compare model.glb --algorithm pcf:kernel=9 --against arealight:radius=0.2\n",
};

static void print_row(const char *name, const struct metrics *m)
{
    printf("%-24.24s %10llu %13llu %10.6f %9.6f %7.3f %7llu %7llu %9.2f\n", name, (unsigned long long)m->receivers,
           (unsigned long long)m->misclassified, m->misclassified_fraction, m->rmse, m->max_abs, (unsigned long long)m->leaks,
           (unsigned long long)m->acne, m->boundary.edge_shift_p95);
}

static void print_lists(const struct comparison *c)
{
    struct identified m = {0};
    for (size_t i = 0; i < c->light_count; i++)
        identified_add(&m, &c->lists[i].result);
    if (m.texels > 0)
        printf(
            "lists hold %.4f of the triangles seen in a texel (all texels pooled: %.4f); the five most visible would be %.4f; %llu of "
            "%llu texels see more than 4\n",
            m.fractions / (double)m.texels, (double)m.found / (double)m.seen, m.oracle_fractions / (double)m.texels,
            (unsigned long long)m.texels_over_4, (unsigned long long)m.texels);
}

static void print_table(const struct compare_options *o, const struct stage *stage, const struct comparison *c)
{
    char against[300], tested[300];
    against_format(&o->against, against, sizeof against);
    shadow_format(stage->settings.system, &stage->settings.params, tested, sizeof tested);
    printf("%s against %s, %ux%u, %zu triangles drawn\n", tested, against, c->width, c->height,
           stage->scene->drawn_triangle_count);
    printf("%-24s %10s %13s %10s %9s %7s %7s %7s %9s\n", "light", "receivers", "misclassified", "fraction", "rmse", "max",
           "leaks", "acne", "edge p95");
    for (size_t i = 0; c->light_count > 1 && i < c->light_count; i++) {
        char name[100];
        const struct light *light = &stage->settings.lights[i];
        snprintf(name, sizeof name, "%zu %s", i, light->name[0] ? light->name : light_kind_names[light->kind]);
        print_row(name, &c->light[i]);
    }
    print_row(c->light_count == 1 ? light_kind_names[stage->settings.lights[0].kind] : "all", &c->total);
    print_lists(c);
    printf("edge p95: 95 %% of the reference's shadow edge lies within that many 1/32 pixels of the tested one\n");
}

static bool check_outputs(const struct compare_options *o, struct error *err)
{
    if (!o->common.system)
        return error_set(err, ERROR_USAGE, "algorithm",
                         "compare needs --algorithm NAME; gnomon list algorithms prints what is accepted");
    if (o->picture && o->json && !strcmp(o->picture, "-") && !strcmp(o->json, "-"))
        return error_set(err, ERROR_USAGE, "json", "-o - and --json - exclude each other: standard output carries one thing");
    bool moves = o->flicker[FLICKER_LIGHT] || o->flicker[FLICKER_CAMERA];
    if (moves && o->against.kind != AGAINST_POINT && o->against.kind != AGAINST_SAMPLES32)
        return error_set(err, ERROR_USAGE, "flicker", "--flicker is accepted against point and samples32 only");
    if (o->flicker_frames && !moves)
        return error_set(err, ERROR_USAGE, "frames", "--frames counts the frames of --flicker, which is missing");
    return (!o->picture || output_check(o->picture, err)) && (!o->json || output_check(o->json, err));
}

/* Times are taken before the comparison, so that its trees do not count in the peak of memory. */
static bool time_frames(const struct compare_options *o, struct stage *stage, json_t **figures, struct error *err)
{
    struct progress progress;
    struct measurement measured;
    unsigned frames = o->common.frames_timed ? o->common.frames_timed : 1;
    progress_init(&progress, "timing", o->common.quiet);
    bool good = measure_frames(stage, frames, o->common.moving, &progress, &measured, err);
    progress_finish(&progress);
    if (!good)
        return false;
    *figures = figures_render(stage->scene, &stage->settings, renderer_device(stage->renderer), &measured);
    return *figures || error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for the figures");
}

static bool report_progress(void *context, double done)
{
    progress_set(context, done);
    return true;
}

/* Fills figures[motion] for each that was asked for. */
static bool measure_flicker(const struct compare_options *o, struct stage *stage, struct flicker_figures *figures,
                            struct error *err)
{
    unsigned frames = o->flicker_frames ? o->flicker_frames : FLICKER_FRAMES_DEFAULT;
    for (int i = 0; i < FLICKER_MOTIONS; i++) {
        struct progress progress;
        if (!o->flicker[i])
            continue;
        progress_init(&progress, "moving", o->common.quiet);
        const struct reference_progress report = {report_progress, &progress};
        bool good = flicker_measure(stage, &o->against, (enum flicker_motion)i, frames, NULL, &report, &figures[i], err);
        progress_finish(&progress);
        if (!good)
            return false;
    }
    return true;
}

static void print_flicker(const struct flicker_figures *figures)
{
    for (int i = 0; i < FLICKER_MOTIONS; i++)
        if (figures[i].frames)
            printf("flicker, %s turning: %.6f, the reference's own %.6f: %+.6f\n", flicker_motion_names[i], figures[i].tested,
                   figures[i].reference, figures[i].difference);
}

/* Beside the figures, or to people. */
static bool add_oracle(const struct compare_options *o, const struct stage *stage, const struct comparison *c, json_t *figures,
                       struct error *err)
{
    struct metrics m;
    struct progress progress;
    if (!o->oracle)
        return true;
    progress_init(&progress, "asking the oracle", o->common.quiet);
    const struct reference_progress report = {report_progress, &progress};
    bool good = comparison_oracle(stage, o->oracle, &report, c, &m, err);
    progress_finish(&progress);
    if (!good || m.receivers == 0)
        return good;
    if (figures) {
        json_t *object = figures_errors(&m);
        json_object_set_new(object, "length", json_integer((json_int_t)o->oracle));
        json_object_set_new(figures, "oracle", object);
    } else {
        printf("lists of the %u most visible triangles of each texel: %llu misclassified, %.6f of the receivers\n", o->oracle,
               (unsigned long long)m.misclassified, m.misclassified_fraction);
    }
    return true;
}

/* The table for people, unless standard output carries something else. */
static bool write_results(const struct compare_options *o, const struct stage *stage, const struct comparison *c,
                          const struct flicker_figures *flicker, json_t **figures, struct error *err)
{
    if (o->picture && !difference_write(c, stage, &o->against, o->picture, o->format, err))
        return false;
    if (o->json) {
        figures_add_comparison(*figures, &o->against, stage, c);
        figures_add_flicker(*figures, flicker);
        json_t *taken = *figures;
        *figures = NULL;
        if (!output_json(o->json, taken, err))
            return false;
    }
    if ((o->json && !strcmp(o->json, "-")) || (o->picture && !strcmp(o->picture, "-")))
        return true;
    print_table(o, stage, c);
    print_flicker(flicker);
    return output_flush(err);
}

static bool compare(const struct compare_options *o, struct stage *stage, struct error *err)
{
    json_t *figures = NULL;
    struct comparison c = {0};
    struct flicker_figures flicker[FLICKER_MOTIONS] = {0};
    struct progress progress;
    if (o->json && !time_frames(o, stage, &figures, err))
        return false;
    progress_init(&progress, "comparing", o->common.quiet);
    const struct reference_progress report = {report_progress, &progress};
    bool good = comparison_render(stage, &o->against, &c, err) && comparison_trace(stage, &o->against, &report, &c, err);
    progress_finish(&progress);
    good = good && add_oracle(o, stage, &c, figures, err) && measure_flicker(o, stage, flicker, err) &&
           write_results(o, stage, &c, flicker, &figures, err);
    json_decref(figures);
    comparison_finish(&c);
    return good;
}

int command_compare(int argc, char **argv)
{
    struct compare_options options = {0};
    struct stage stage = {0};
    struct error err = {0};
    const char *scene = NULL;
    common_options_init(&options.common);
    int code = options_start(&syntax, argc, argv, &options, &options.common, &scene);
    if (code >= 0)
        return code;
    bool good =
        check_outputs(&options, &err) && stage_init(&stage, scene, &options.common, &err) && compare(&options, &stage, &err);
    stage_finish(&stage);
    return good ? 0 : command_fail(&err);
}
