#include "builtin/builtin.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "builtin/scenes.h"

const struct builtin_desc *const builtin_list[] = {
    &builtin_box.desc,          &builtin_ball.desc,           &builtin_tree.desc,
    &builtin_butterfly.desc,    &builtin_dragon.desc,         &builtin_room.desc,
    &builtin_contact.desc,      &builtin_hard_grazing.desc,   &builtin_hard_plane.desc,
    &builtin_hard_sliver.desc,  &builtin_hard_contact.desc,   &builtin_hard_noise.desc,
    &builtin_hard_fan.desc,     &builtin_hard_tjunction.desc, &builtin_hard_depth.desc,
    &builtin_hard_thin.desc,    &builtin_hard_duplicate.desc, &builtin_hard_degenerate.desc,
    &builtin_hard_behind.desc,  &builtin_hard_near.desc,      &builtin_hard_far.desc,
    &builtin_hard_offset.desc,  &builtin_hard_scale.desc,     &builtin_hard_ratio.desc,
    &builtin_hard_seams.desc,   &builtin_hard_cards.desc,     &builtin_hard_twosided.desc,
    &builtin_hard_grid.desc,    &builtin_hard_million.desc,   &builtin_hard_facets.desc,
    &builtin_hard_clipped.desc, &builtin_hard_sheets.desc,
};

const size_t builtin_count = sizeof builtin_list / sizeof builtin_list[0];

_Static_assert(offsetof(struct builtin_scene, desc) == 0, "a listed descriptor is the start of its scene");

/* A piece of the name that is being read. */
struct text {
    const char *start;
    int length;
};

static struct text text_until(const char *start, const char *stop) { return (struct text){start, (int)strcspn(start, stop)}; }

static bool text_is(struct text t, const char *word)
{
    return strlen(word) == (size_t)t.length && memcmp(t.start, word, (size_t)t.length) == 0;
}

static const struct builtin_scene *find_scene(struct text name, struct error *err)
{
    char known[200] = "";
    size_t models = 0;
    for (size_t i = 0; i < builtin_count; i++) {
        if (text_is(name, builtin_list[i]->name))
            return (const struct builtin_scene *)builtin_list[i];
        if (strncmp(builtin_list[i]->name, "hard-", 5) == 0)
            continue;
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", models++ > 0 ? ", " : "", builtin_list[i]->name);
    }
    error_set(
        err, ERROR_NO_INPUT, "scene",
        "unknown built-in scene '%.*s'; known are %s and the hard cases hard-01-grazing to hard-25-sheets (gnomon list scenes)",
        name.length > 60 ? 60 : name.length, name.start, known);
    return NULL;
}

static void list_params(const struct builtin_scene *scene, char *out, size_t size)
{
    const struct builtin_param *p = scene->desc.params;
    snprintf(out, size, "none");
    for (size_t used = 0; p && p->name && used < size; p++)
        used += (size_t)snprintf(out + used, size - used, "%s%s", used > 0 ? ", " : "", p->name);
}

/* The parameter's number; -1 with `err` set when there is none of that name. */
static int find_param(const struct builtin_scene *scene, struct text key, struct error *err)
{
    const struct builtin_param *params = scene->desc.params;
    for (int i = 0; params && params[i].name; i++)
        if (text_is(key, params[i].name))
            return i;
    char known[200];
    list_params(scene, known, sizeof known);
    error_set(err, ERROR_USAGE, "scene", "builtin:%s has no parameter '%.*s'; it takes %s", scene->desc.name,
              key.length > 60 ? 60 : key.length, key.start, known);
    return -1;
}

static bool parse_value(const struct builtin_scene *scene, const struct builtin_param *p, struct text written, double *value,
                        struct error *err)
{
    char copy[40], *end = copy;
    if (written.length > 0 && written.length < (int)sizeof copy) {
        memcpy(copy, written.start, (size_t)written.length);
        copy[written.length] = 0;
        /* strtod() would also take spaces, hexadecimal, inf and nan. */
        *value = strspn(copy, "+-.0123456789eE") == (size_t)written.length ? strtod(copy, &end) : NAN;
    }
    bool number = end != copy && *end == 0 && *value >= p->min && *value <= p->max && (!p->whole || *value == floor(*value));
    if (number)
        return true;
    return error_set(err, ERROR_USAGE, "scene", "builtin:%s: '%.*s' is not a value for %s; it takes a %snumber from %g to %.10g",
                     scene->desc.name, written.length > 40 ? 40 : written.length, written.start, p->name,
                     p->whole ? "whole " : "", p->min, p->max);
}

/* One key=value. `given`: a bit a parameter. */
static bool parse_pair(const struct builtin_scene *scene, struct text pair, double *values, unsigned *given, struct error *err)
{
    struct text key = text_until(pair.start, "=,");
    if (key.length == 0 || key.length >= pair.length)
        return error_set(err, ERROR_USAGE, "scene", "builtin:%s: '%.*s' is not key=value; write builtin:NAME[:key=value,...]",
                         scene->desc.name, pair.length > 60 ? 60 : pair.length, pair.start);
    int index = find_param(scene, key, err);
    if (index < 0)
        return false;
    const struct builtin_param *p = &scene->desc.params[index];
    if (*given & 1u << index)
        return error_set(err, ERROR_USAGE, "scene", "builtin:%s: %s is given twice; give it once", scene->desc.name, p->name);
    *given |= 1u << index;
    struct text written = {pair.start + key.length + 1, pair.length - key.length - 1};
    return parse_value(scene, p, written, &values[index], err);
}

/* `list` is what follows the scene's name: "" or ":key=value,...". */
static bool parse_params(const struct builtin_scene *scene, const char *list, double *values, struct error *err)
{
    unsigned given = 0;
    for (int i = 0; scene->desc.params && scene->desc.params[i].name; i++)
        values[i] = scene->desc.params[i].initial;
    while (*list) {
        struct text pair = text_until(list + 1, ",");
        if (!parse_pair(scene, pair, values, &given, err))
            return false;
        list = pair.start + pair.length;
    }
    return true;
}

struct scene *builtin_make(const char *name, struct error *err)
{
    if (strlen(name) > 1000) {
        error_set(err, ERROR_USAGE, "scene", "the name of the built-in scene is too long; write builtin:NAME[:key=value,...]");
        return NULL;
    }
    struct text base = text_until(name, ":");
    const struct builtin_scene *scene = find_scene(base, err);
    double values[BUILTIN_MAX_PARAMS] = {0};
    if (!scene || !parse_params(scene, name + base.length, values, err))
        return NULL;
    char full_name[128];
    snprintf(full_name, sizeof full_name, "builtin:%s", name);
    struct mesh_builder b = {0};
    scene->make(&b, values);
    return mesh_builder_finish(&b, full_name, err);
}
