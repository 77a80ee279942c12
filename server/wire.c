#include "wire.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "lights.h"
#include "listings.h"
#include "protocol.h"
#include "numbers.h"
#include "output.h"

#define EXPOSURE_MAX_EV 64

static struct dvec3 vector(const double v[3]) { return dvec3(v[0], v[1], v[2]); }

static bool read_look_at(const json_t *value, struct camera_choice *out, struct error *err)
{
    struct look_at_members m = {.up = {0, 1, 0}, .fov = FOV_DEFAULT_DEG};
    struct given given;
    if (!members_read(value, "camera", look_at_members, &m, &given, err))
        return false;
    *out = (struct camera_choice){.source = CAMERA_LOOK_AT,
                                  .eye = vector(m.eye),
                                  .target = vector(m.target),
                                  .up = vector(m.up),
                                  .fov_deg = m.fov,
                                  .height = m.height};
    if (is_given(given, LOOK_AT_FOV) && is_given(given, LOOK_AT_HEIGHT))
        return error_set(err, ERROR_USAGE, "camera.height", "camera.height and camera.fov exclude each other: give one of them");
    return camera_check_look_at(out, err);
}

bool wire_read_camera(const json_t *value, struct camera_choice *out, char name[WIRE_CAMERA_NAME_MAX], struct error *err)
{
    if (json_is_object(value))
        return read_look_at(value, out, err);
    bool is_name = json_is_string(value) && json_string_length(value) > 0 && json_string_length(value) < WIRE_CAMERA_NAME_MAX;
    if (!is_name && !(json_is_integer(value) && json_integer_value(value) >= 0))
        return error_set(err, ERROR_USAGE, "camera",
                         "camera has the wrong form; a name, an index or {eye, target, up, fov or height} is accepted");
    if (is_name)
        snprintf(name, WIRE_CAMERA_NAME_MAX, "%s", json_string_value(value));
    else
        snprintf(name, WIRE_CAMERA_NAME_MAX, "%lld", (long long)json_integer_value(value));
    *out = (struct camera_choice){.source = CAMERA_NAMED, .name = name};
    return true;
}

static bool read_light_key(struct light *light, const char *key, const json_t *value, struct error *err)
{
    double values[3];
    size_t count = light_key_values(light->kind, key, err);
    if (count == 0) {
        snprintf(err->field, sizeof err->field, "%s", key);
        return false;
    }
    bool good = count == 1 ? json_is_number(value) : json_is_array(value) && json_array_size(value) == count;
    for (size_t i = 0; good && i < count; i++) {
        const json_t *item = count == 1 ? value : json_array_get(value, i);
        good = json_is_number(item);
        values[i] = json_number_value(item);
    }
    if (!good)
        return error_set(err, ERROR_USAGE, key, "light.%s has the wrong form; %s is accepted", key,
                         count == 1 ? "a number" : "an array of three numbers");
    return light_set(light, key, values, err);
}

bool wire_read_light(const struct scene *scene, const json_t *value, const struct light *light, struct light *out,
                     struct error *err)
{
    const json_t *kind_name = json_object_get(value, "kind");
    int kind = json_is_string(kind_name) ? name_index(light_kind_names, json_string_value(kind_name)) : -1;
    if (!json_is_object(value) || (kind < 0 && (kind_name || !light)))
        return error_set(err, ERROR_USAGE, "kind", "a light is an object with a kind; directional, point or spot is accepted");
    struct light read = kind < 0 || (light && (int)light->kind == kind) ? *light : light_default((enum light_kind)kind);
    if (light && read.kind == light->kind)
        read.position = dvec3_add(light->position, scene->origin);
    const char *key;
    json_t *item;
    json_object_foreach((json_t *)value, key,
                        item) if (strcmp(key, "kind") != 0 && !read_light_key(&read, key, item, err)) return false;
    if (!light_check(&read, err))
        return false;
    *out = light_from_world(scene, &read);
    return true;
}

bool wire_read_lights(const struct scene *scene, const json_t *value, struct render_settings *settings, struct error *err)
{
    size_t count = json_array_size(value);
    if (!json_is_array(value) || count > RENDERER_LIGHTS_MAX)
        return error_set(err, ERROR_USAGE, "lights", "lights: an array is wanted; 0 to %d lights are accepted",
                         RENDERER_LIGHTS_MAX);
    struct light lights[RENDERER_LIGHTS_MAX];
    for (size_t i = 0; i < count; i++)
        if (!wire_read_light(scene, json_array_get(value, i), NULL, &lights[i], err))
            return error_prefix(err, "lights[%zu]", i);
    memcpy(settings->lights, lights, count * sizeof lights[0]);
    settings->light_count = count;
    return true;
}

bool wire_read_algorithm(const char *text, struct render_settings *settings, struct error *err)
{
    if (shadow_parse(text, &settings->system, &settings->params, err))
        return true;
    if (strcmp(err->field, "algorithm") != 0) {
        char key[sizeof err->field];
        memcpy(key, err->field, sizeof key);
        snprintf(err->field, sizeof err->field, "algorithm.%.40s", key);
    }
    return false;
}

bool wire_read_exposure(const json_t *value, struct render_settings *settings, struct error *err)
{
    const char *text = json_string_value(value);
    bool is_auto = text && strcmp(text, "auto") == 0;
    if (!is_auto && !(json_is_number(value) && fabs(json_number_value(value)) <= EXPOSURE_MAX_EV))
        return error_set(err, ERROR_USAGE, "exposure", "exposure has the wrong form; \"auto\" or -%d to %d stops are accepted",
                         EXPOSURE_MAX_EV, EXPOSURE_MAX_EV);
    settings->exposure_auto = is_auto;
    if (!is_auto)
        settings->exposure_ev = json_number_value(value);
    return true;
}

json_t *wire_camera(const struct scene *scene, const struct camera *camera)
{
    struct dvec3 center = dbox_is_empty(&scene->bounds) ? dvec3(0, 0, 0) : dbox_center(&scene->bounds);
    double distance = -dvec3_dot(dvec3_sub(center, camera->eye), camera->back);
    double least = fmax(dbox_radius(&scene->bounds) * 0.1, camera->near);
    if (!(distance > least))
        distance = least > 0 ? least : 1;
    struct dvec3 eye = dvec3_add(camera->eye, scene->origin);
    struct dvec3 target = dvec3_mad(eye, camera->back, -distance);
    json_t *object = json_pack("{s:o, s:o, s:o, s:o}", "eye", listing_point(eye), "target", listing_point(target), "up",
                               listing_point(camera->up), "name", json_text(camera->name));
    if (camera->orthographic)
        json_object_set_new(object, "height", json_number(2 * camera->ymag));
    else
        json_object_set_new(object, "fov", json_number(camera->yfov * (180 / M_PI)));
    return object;
}

json_t *wire_lights(const struct scene *scene, const struct render_settings *settings)
{
    json_t *lights = json_array();
    for (size_t i = 0; i < settings->light_count; i++)
        json_array_append_new(lights, listing_light(scene, &settings->lights[i]));
    return lights;
}

json_t *wire_scene(const char *name, const struct scene *scene)
{
    json_t *cameras = json_array(), *lights = json_array();
    for (size_t i = 0; i < scene->camera_count; i++)
        json_array_append_new(cameras, listing_camera(scene, &scene->cameras[i]));
    for (size_t i = 0; i < scene->light_count; i++)
        json_array_append_new(lights, listing_light(scene, &scene->lights[i]));
    json_t *bounds = dbox_is_empty(&scene->bounds)
                         ? json_null()
                         : json_pack("{s:o, s:o}", "min", listing_point(dvec3_add(scene->bounds.min, scene->origin)), "max",
                                     listing_point(dvec3_add(scene->bounds.max, scene->origin)));
    return json_pack("{s:s, s:I, s:I, s:I, s:o, s:o, s:o}", "scene", name, "triangles", (json_int_t)(scene->index_count / 3),
                     "drawn_triangles", (json_int_t)scene->drawn_triangle_count, "vertices", (json_int_t)scene->vertex_count,
                     "bounds", bounds, "cameras", cameras, "lights", lights);
}
