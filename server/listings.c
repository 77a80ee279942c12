#include "listings.h"

#include <math.h>
#include <stdio.h>

#include "builtin/builtin.h"
#include "lights.h"
#include "output.h"

/* A number that is whole by its nature, or any other. */
static json_t *range_number(double value, bool whole) { return whole ? json_integer((json_int_t)value) : json_number(value); }

static json_t *builtin_params(const struct builtin_param *params)
{
    json_t *array = json_array();
    for (const struct builtin_param *p = params; p && p->name; p++)
        json_array_append_new(array, json_pack("{s:s, s:s, s:s, s:o, s:o, s:o}", "name", p->name, "help", p->help, "kind",
                                               p->whole ? "int" : "float", "min", range_number(p->min, p->whole), "max",
                                               range_number(p->max, p->whole), "default", range_number(p->initial, p->whole)));
    return array;
}

json_t *listing_scenes(void)
{
    json_t *array = json_array();
    for (size_t i = 0; i < builtin_count; i++) {
        const struct builtin_desc *b = builtin_list[i];
        char name[128];
        snprintf(name, sizeof name, "builtin:%s", b->name);
        json_array_append_new(array,
                              json_pack("{s:s, s:s, s:o}", "name", name, "help", b->help, "params", builtin_params(b->params)));
    }
    return array;
}

static json_t *choices(const struct param_desc *p)
{
    json_t *array = json_array();
    for (size_t i = 0; p->choices[i]; i++)
        json_array_append_new(array, json_string(p->choices[i]));
    return array;
}

static json_t *algorithm_param(const struct param_desc *p)
{
    static const char *const kinds[] = {[PARAM_INT] = "int", [PARAM_FLOAT] = "float", [PARAM_CHOICE] = "choice"};
    json_t *object = json_pack("{s:s, s:s, s:s, s:s}", "name", p->name, "unit", p->unit, "help", p->help, "kind", kinds[p->kind]);
    if (p->kind == PARAM_CHOICE) {
        json_object_set_new(object, "choices", choices(p));
        json_object_set_new(object, "default", json_string(p->choices[(size_t)p->initial]));
        return object;
    }
    bool whole = p->kind == PARAM_INT;
    json_object_set_new(object, "min", range_number(p->min, whole));
    json_object_set_new(object, "max", range_number(p->max, whole));
    json_object_set_new(object, "default", range_number(p->initial, whole));
    if (p->odd)
        json_object_set_new(object, "odd", json_true());
    return object;
}

static json_t *algorithm_lights(const struct shadow_system *system)
{
    json_t *array = json_array();
    for (unsigned kind = 0; light_kind_names[kind]; kind++)
        if (system->lights & 1u << kind)
            json_array_append_new(array, json_string(light_kind_names[kind]));
    return array;
}

json_t *listing_algorithms(void)
{
    json_t *array = json_array();
    for (size_t i = 0; i < shadow_system_count; i++) {
        const struct shadow_system *s = shadow_systems[i];
        json_t *params = json_array();
        for (size_t p = 0; p < s->param_count; p++)
            json_array_append_new(params, algorithm_param(&s->params[p]));
        json_array_append_new(array, json_pack("{s:s, s:s, s:s, s:o, s:o}", "name", s->name, "title", s->title, "help", s->help,
                                               "lights", algorithm_lights(s), "params", params));
    }
    return array;
}

json_t *listing_devices(const struct device_info *devices, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++) {
        const struct device_info *d = &devices[i];
        json_array_append_new(array, json_pack("{s:o, s:s, s:o, s:o, s:o, s:o, s:o, s:b, s:b, s:o}", "index",
                                               d->index < 0 ? json_null() : json_integer(d->index), "platform", d->platform,
                                               "node", json_text(d->node), "vendor", json_text(d->vendor), "renderer",
                                               json_text(d->renderer), "version", json_text(d->version), "cuda",
                                               d->cuda < 0 ? json_null() : json_integer(d->cuda), "software", d->software,
                                               "usable", d->why_not[0] == 0, "why_not", json_text(d->why_not)));
    }
    return array;
}

json_t *listing_point(struct dvec3 p)
{
    p = dvec3_add(p, dvec3(0, 0, 0)); /* -0 becomes 0 */
    return json_pack("[o, o, o]", json_number(p.x), json_number(p.y), json_number(p.z));
}

static json_t *degrees(double radians) { return json_number(radians * (180 / M_PI)); }

json_t *listing_light(const struct scene *scene, const struct light *l)
{
    json_t *object = json_pack("{s:o, s:s, s:[o, o, o], s:o}", "name", json_text(l->name), "kind", light_kind_names[l->kind],
                               "color", json_number(l->color[0]), json_number(l->color[1]), json_number(l->color[2]), "intensity",
                               json_number(l->intensity));
    if (l->kind != LIGHT_DIRECTIONAL)
        json_object_set_new(object, "position", listing_point(dvec3_add(l->position, scene->origin)));
    if (l->kind != LIGHT_POINT)
        json_object_set_new(object, "direction", listing_point(l->direction));
    if (l->kind == LIGHT_SPOT) {
        json_object_set_new(object, "inner", degrees(l->inner));
        json_object_set_new(object, "outer", degrees(l->outer));
    }
    if (l->range > 0)
        json_object_set_new(object, "range", json_number(l->range));
    if (l->radius > 0)
        json_object_set_new(object, "radius", json_number(l->radius));
    return object;
}

json_t *listing_camera(const struct scene *scene, const struct camera *c)
{
    json_t *object = json_pack("{s:o, s:s, s:o, s:o, s:o, s:o, s:o}", "name", json_text(c->name), "kind",
                               c->orthographic ? "orthographic" : "perspective", "eye",
                               listing_point(dvec3_add(c->eye, scene->origin)), "forward", listing_point(dvec3_neg(c->back)),
                               "up", listing_point(c->up), "near", json_number(c->near), "far", json_number(c->far));
    if (c->orthographic)
        json_object_set_new(object, "height", json_number(2 * c->ymag));
    else
        json_object_set_new(object, "fov", degrees(c->yfov));
    return object;
}
