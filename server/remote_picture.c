#include "remote_picture.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "common_options.h"
#include "listings.h"
#include "numbers.h"
#include "progress.h"

static json_t *size_value(const struct common_options *o) { return json_pack("[i, i]", (int)o->width, (int)o->height); }

static json_t *camera_value(const struct common_options *o)
{
    const struct camera_choice *c = &o->camera;
    if (c->source != CAMERA_LOOK_AT)
        return json_string(c->name);
    bool orthographic = c->height > 0;
    return json_pack("{s:o, s:o, s:o, s:f}", "eye", listing_point(c->eye), "target", listing_point(c->target), "up",
                     listing_point(c->up), orthographic ? "height" : "fov", orthographic ? c->height : c->fov_deg);
}

/* From the text and not the light, whose angles and vectors went through radians and unit length: the server shall make the same of it. */
static json_t *light_value(const char *text)
{
    char *copy = strdup(text), *rest = NULL, *word = copy ? strtok_r(copy, " \t\n", &rest) : NULL;
    json_t *light = word ? json_pack("{s:s}", "kind", word) : NULL;
    while (light && (word = strtok_r(NULL, " \t\n", &rest))) {
        char *equals = strchr(word, '=');
        double v[3];
        *equals = 0;
        bool one = number_parse_list(equals + 1, v, 1);
        json_t *value = one                                   ? json_real(v[0])
                        : number_parse_list(equals + 1, v, 3) ? json_pack("[f, f, f]", v[0], v[1], v[2])
                                                              : NULL;
        json_object_set_new(light, word, value);
    }
    free(copy);
    return light;
}

static json_t *lights_value(const struct common_options *o)
{
    json_t *lights = json_array();
    for (size_t i = 0; i < o->light_count; i++)
        json_array_append_new(lights, light_value(o->light_texts[i]));
    return lights;
}

static json_t *algorithm_value(const struct common_options *o) { return json_string(common_options_given(o, "algorithm")); }
static json_t *show_value(const struct common_options *o) { return json_string(show_names[o->show]); }
static json_t *exposure_value(const struct common_options *o)
{
    return o->exposure_auto ? json_string("auto") : json_real(o->exposure_ev);
}
static json_t *ambient_value(const struct common_options *o) { return json_real(o->ambient); }
static json_t *tonemap_value(const struct common_options *o) { return json_string(tonemap_names[o->tonemap]); }
static json_t *aa_value(const struct common_options *o) { return json_integer(o->aa); }
static json_t *camera_pass_value(const struct common_options *o) { return json_string(camera_pass_names[o->camera_pass]); }

/* Options that become members. Those without a member stay on this side; those not listed belong to where the server was started. */
static const struct carried {
    const char *option, *member;
    json_t *(*value)(const struct common_options *o);
} carried[] = {
    {"size", "size", size_value},
    {"camera", "camera", camera_value},
    {"eye", "camera", camera_value},
    {"target", "camera", camera_value},
    {"up", "camera", camera_value},
    {"fov", "camera", camera_value},
    {"ortho", "camera", camera_value},
    {"light", "lights", lights_value},
    {"algorithm", "algorithm", algorithm_value},
    {"show", "show", show_value},
    {"exposure", "exposure", exposure_value},
    {"ambient", "ambient", ambient_value},
    {"tonemap", "tonemap", tonemap_value},
    {"aa", "aa", aa_value},
    {"camera-pass", "camera_pass", camera_pass_value},
    {"quiet", NULL, NULL},
    {"log-level", NULL, NULL},
};

static const struct carried *find(const char *option)
{
    for (size_t i = 0; i < sizeof carried / sizeof carried[0]; i++)
        if (strcmp(carried[i].option, option) == 0)
            return &carried[i];
    return NULL;
}

static bool add_given(json_t *body, const struct common_options *o, struct error *err)
{
    for (const struct option *option = common_option_table; option->name; option++) {
        if (!common_options_given(o, option->name))
            continue;
        const struct carried *c = find(option->name);
        if (!c)
            return error_set(err, ERROR_USAGE, option->name,
                             "--%s cannot be sent to a server, which was started with its own; leave it or --server out",
                             option->name);
        if (c->member && json_object_set_new(body, c->member, c->value(o)) != 0)
            return error_set(err, ERROR_USAGE, option->name, "--%s: only text in UTF-8 can be sent to a server", option->name);
    }
    return true;
}

static json_t *make_body(const char *scene, const struct common_options *options, enum image_format format, int quality,
                         struct error *err)
{
    static const char *const formats[] = {[IMAGE_PNG] = "png", [IMAGE_JPEG] = "jpeg", [IMAGE_WEBP] = "webp", [IMAGE_EXR] = "exr"};
    json_t *body = json_pack("{s:s, s:s, s:i}", "scene", scene, "format", formats[format], "quality", quality);
    if (!body)
        error_set(err, ERROR_USAGE, "arguments", "SCENE: only a name in UTF-8 can be sent to a server");
    if (body && add_given(body, options, err))
        return body;
    json_decref(body);
    return NULL;
}

static bool is_picture(enum image_format format, const struct remote_answer *a)
{
    static const struct {
        size_t at, size;
        const char *bytes;
    } magic[] = {[IMAGE_PNG] = {0, 4, "\x89PNG"},
                 [IMAGE_JPEG] = {0, 3, "\xff\xd8\xff"},
                 [IMAGE_WEBP] = {8, 4, "WEBP"},
                 [IMAGE_EXR] = {0, 4, "\x76\x2f\x31\x01"}};
    return a->size >= magic[format].at + magic[format].size &&
           memcmp(a->data + magic[format].at, magic[format].bytes, magic[format].size) == 0;
}

bool remote_picture(const struct remote *remote, const char *scene, const struct common_options *options,
                    enum image_format format, int quality, struct remote_answer *out, struct error *err)
{
    struct progress progress;
    json_t *body = make_body(scene, options, format, quality, err);
    if (!body)
        return false;
    progress_init(&progress, "waiting for the server", options->quiet);
    bool good = remote_ask(remote, "/v1/render", body, out, err);
    progress_finish(&progress);
    if (!good || is_picture(format, out))
        return good;
    free(out->data);
    return error_set(err, ERROR_IO, "server",
                     "%s answered with %zu bytes that are no picture: the address of a running gnomon serve is accepted",
                     remote->url, out->size);
}
