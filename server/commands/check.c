#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "command.h"
#include "import/import.h"
#include "lights.h"
#include "listings.h"
#include "options.h"
#include "output.h"

struct check_options {
    const char *json; /* NULL: text */
};

static bool set_json(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct check_options *)target)->json = value;
    return true;
}

static const struct option option_table[] = {
    {"json", "FILE", "write the summary as JSON; - is standard output", set_json},
    {0},
};

static const struct syntax syntax = {
    .command = "check",
    .usage = "SCENE [--json FILE]",
    .summary = "Loads and validates a scene and says what is in it; never renders.",
    .operand = "SCENE",
    .options = option_table,
    .notes =
        "Exit code 0: good, warnings or not. 65: the scene is bad, with what is wrong and where. 66: there is no such scene.\n",
    .examples = "  gnomon check model.glb\n"
                "  gnomon check builtin:dragon:triangles=100000 --json -\n",
};

static const char *const alpha_mode_names[] = {[ALPHA_OPAQUE] = "opaque", [ALPHA_MASK] = "mask", [ALPHA_BLEND] = "blend"};

static json_t *material_json(const struct material *m)
{
    return json_pack("{s:o, s:s, s:b, s:b}", "name", json_text(m->name), "alpha_mode", alpha_mode_names[m->alpha_mode],
                     "double_sided", m->double_sided, "textured", m->base_color_texture.texture != SCENE_NONE);
}

static json_t *image_json(const struct image *image)
{
    return json_pack("{s:o, s:I, s:I}", "name", json_text(image->name), "width", (json_int_t)image->width, "height",
                     (json_int_t)image->height);
}

static json_t *bounds_json(const struct scene *scene)
{
    if (dbox_is_empty(&scene->bounds))
        return json_null();
    return json_pack("{s:o, s:o}", "min", listing_point(dvec3_add(scene->bounds.min, scene->origin)), "max",
                     listing_point(dvec3_add(scene->bounds.max, scene->origin)));
}

static json_t *counts_json(const struct scene *s)
{
    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "triangles", (json_int_t)s->triangle_count,
                     "drawn_triangles", (json_int_t)s->drawn_triangle_count, "vertices", (json_int_t)s->vertex_count, "meshes",
                     (json_int_t)s->mesh_count, "instances", (json_int_t)s->instance_count, "materials",
                     (json_int_t)s->material_count, "textures", (json_int_t)s->texture_count, "images",
                     (json_int_t)s->image_count, "lights", (json_int_t)s->light_count, "cameras", (json_int_t)s->camera_count);
}

static json_t *summary_json(const char *name, const struct scene *scene, const struct import_report *report)
{
    char hash[20];
    snprintf(hash, sizeof hash, "%016" PRIx64, scene->hash);
    json_t *materials = json_array(), *images = json_array(), *lights = json_array(), *cameras = json_array();
    json_t *warnings = json_array();
    for (size_t i = 0; i < scene->material_count; i++)
        json_array_append_new(materials, material_json(&scene->materials[i]));
    for (size_t i = 0; i < scene->image_count; i++)
        json_array_append_new(images, image_json(&scene->images[i]));
    for (size_t i = 0; i < scene->light_count; i++)
        json_array_append_new(lights, listing_light(scene, &scene->lights[i]));
    for (size_t i = 0; i < scene->camera_count; i++)
        json_array_append_new(cameras, listing_camera(scene, &scene->cameras[i]));
    for (size_t i = 0; i < report->warning_count; i++)
        json_array_append_new(warnings, json_text(report->warnings[i]));
    return json_pack("{s:s, s:o, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "version", GNOMON_VERSION, "scene", json_text(name),
                     "hash", hash, "counts", counts_json(scene), "bounds", bounds_json(scene), "materials", materials, "images",
                     images, "lights", lights, "cameras", cameras, "warnings", warnings);
}

/* Names come from files: what could steer a terminal is not printed. */
static void print_text(const char *text)
{
    for (const char *c = text; *c; c++)
        putchar((unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c);
}

static void print_light(const struct scene *scene, const struct light *l)
{
    printf("light       \"");
    print_text(l->name);
    printf("\" %s, intensity %g", light_kind_names[l->kind], (double)l->intensity);
    struct dvec3 p = dvec3_add(l->position, scene->origin);
    if (l->kind != LIGHT_DIRECTIONAL)
        printf(", position %g,%g,%g", p.x, p.y, p.z);
    if (l->kind != LIGHT_POINT)
        printf(", direction %g,%g,%g", l->direction.x, l->direction.y, l->direction.z);
    putchar('\n');
}

static void print_camera(const struct scene *scene, size_t index)
{
    const struct camera *c = &scene->cameras[index];
    struct dvec3 eye = dvec3_add(c->eye, scene->origin);
    printf("camera      %zu \"", index);
    print_text(c->name);
    printf("\" %s, eye %g,%g,%g\n", c->orthographic ? "orthographic" : "perspective", eye.x, eye.y, eye.z);
}

static void print_bounds(const struct scene *s)
{
    if (dbox_is_empty(&s->bounds)) {
        printf("bounds      empty\n");
        return;
    }
    struct dvec3 min = dvec3_add(s->bounds.min, s->origin), max = dvec3_add(s->bounds.max, s->origin);
    printf("bounds      %g,%g,%g to %g,%g,%g\n", min.x, min.y, min.z, max.x, max.y, max.z);
}

static void print_summary(const char *name, const struct scene *s, const struct import_report *report)
{
    size_t modes[3] = {0};
    for (size_t i = 0; i < s->material_count; i++)
        modes[s->materials[i].alpha_mode]++;
    printf("scene       %s\n", name);
    printf("triangles   %zu stored, %zu drawn\n", s->triangle_count, s->drawn_triangle_count);
    printf("vertices    %zu\n", s->vertex_count);
    printf("meshes      %zu, in %zu instances\n", s->mesh_count, s->instance_count);
    printf("materials   %zu: %zu opaque, %zu mask, %zu blend\n", s->material_count, modes[ALPHA_OPAQUE], modes[ALPHA_MASK],
           modes[ALPHA_BLEND]);
    printf("images      %zu\n", s->image_count);
    print_bounds(s);
    if (!s->light_count)
        printf("light       none: one directional light will be used\n");
    for (size_t i = 0; i < s->light_count; i++)
        print_light(s, &s->lights[i]);
    if (!s->camera_count)
        printf("camera      none: one that frames the scene will be used\n");
    for (size_t i = 0; i < s->camera_count; i++)
        print_camera(s, i);
    for (size_t i = 0; i < report->warning_count; i++) {
        printf("warning     ");
        print_text(report->warnings[i]);
        putchar('\n');
    }
}

/* Adds what this program, not the file's reader, will pass over. */
static bool add_warnings(const struct scene *scene, struct import_report *report, struct error *err)
{
    if (scene->light_count <= RENDERER_LIGHTS_MAX)
        return true;
    void *grown = realloc(report->warnings, (report->warning_count + 1) * sizeof report->warnings[0]);
    if (!grown)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for the warnings");
    report->warnings = grown;
    snprintf(report->warnings[report->warning_count++], sizeof report->warnings[0], "%zu lights: the first %d are used",
             scene->light_count, RENDERER_LIGHTS_MAX);
    return true;
}

static bool report_scene(const char *name, const struct check_options *options, const struct scene *scene,
                         const struct import_report *report, struct error *err)
{
    if (options->json)
        return output_json(options->json, summary_json(name, scene, report), err);
    print_summary(name, scene, report);
    return output_flush(err);
}

int command_check(int argc, char **argv)
{
    struct check_options options = {0};
    const char *name = NULL;
    int code = options_start(&syntax, argc, argv, &options, NULL, &name);
    if (code >= 0)
        return code;
    struct error err = {0};
    struct import_report report = {0};
    struct scene *scene = NULL;
    bool good = !options.json || output_check(options.json, &err);
    if (good)
        scene = strncmp(name, "builtin:", 8) ? import_gltf(name, &report, &err) : scene_load(name, &err);
    good = scene && add_warnings(scene, &report, &err) && report_scene(name, &options, scene, &report, &err);
    scene_destroy(scene);
    free(report.warnings);
    return good ? 0 : command_fail(&err);
}
