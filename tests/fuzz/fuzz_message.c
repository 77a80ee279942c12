/* A text message, as the socket would get it: JSON, method, parameters by the method's table, then cameras, lights and exposure of them. */
#include <assert.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "protocol.h"
#include "scene/scene.h"
#include "wire.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void read_parts(const struct scene *scene, const struct params *p, struct given given)
{
    struct error err = {0};
    struct camera_choice camera;
    char name[WIRE_CAMERA_NAME_MAX];
    struct render_settings settings = {0};
    struct light light;
    if (is_given(given, PARAM_CAMERA) && !wire_read_camera(p->camera, &camera, name, &err))
        assert(err.code == ERROR_USAGE && err.message[0]);
    if (is_given(given, PARAM_LIGHTS) && wire_read_lights(scene, p->lights, &settings, &err))
        assert(settings.light_count <= RENDERER_LIGHTS_MAX);
    if (is_given(given, PARAM_EXPOSURE))
        wire_read_exposure(p->exposure, &settings, &err);
    if (is_given(given, PARAM_LIGHT) && wire_read_light(scene, p->light, NULL, &light, &err))
        assert(dvec3_finite(light.position) && light.intensity >= 0);
}

/* What a handler relies on: every member that is there is of its kind and within its range. */
static void check(const struct member *m, const struct params *params)
{
    const char *field = (const char *)params + m->offset;
    if (m->kind == MEMBER_INTEGER)
        assert((double)*(const uint64_t *)field >= m->min && (double)*(const uint64_t *)field <= m->max);
    for (size_t i = 0; i < (m->kind == MEMBER_NUMBERS ? m->count : m->kind == MEMBER_NUMBER); i++)
        assert(((const double *)field)[i] >= m->min && ((const double *)field)[i] <= m->max);
    if (m->kind == MEMBER_STRING)
        assert(strlen(*(const char *const *)field) <= m->max);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct scene *scene;
    struct error err = {0};
    if (!scene)
        scene = scene_load("builtin:box", &err);
    assert(scene);
    json_t *message = json_loadb((const char *)data, size, JSON_REJECT_DUPLICATES | JSON_DECODE_ANY, NULL);
    const char *name = json_string_value(json_object_get(message, "method"));
    for (const struct method *m = methods; name && m->name; m++) {
        struct params params = {0};
        struct given given;
        if (strcmp(m->name, name) != 0)
            continue;
        if (!members_read(json_object_get(message, "params"), "", m->members, &params, &given, &err)) {
            assert(err.code == ERROR_USAGE && err.message[0]);
            continue;
        }
        for (const struct member *p = m->members; p->name; p++)
            if (is_given(given, p->bit))
                check(p, &params);
        read_parts(scene, &params, given);
    }
    json_decref(message);
    return 0;
}
