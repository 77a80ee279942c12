#include "lights.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "numbers.h"

const char *const light_kind_names[] = {
    [LIGHT_DIRECTIONAL] = "directional",
    [LIGHT_POINT] = "point",
    [LIGHT_SPOT] = "spot",
    NULL,
};

enum { DIRECTIONAL = 1 << LIGHT_DIRECTIONAL, POINT = 1 << LIGHT_POINT, SPOT = 1 << LIGHT_SPOT };

enum property { POSITION, DIRECTION, COLOR, INTENSITY, RADIUS, INNER, OUTER, RANGE };

/* The largest intensity stays finite in fp32 after it is multiplied by the largest colour and summed over all lights; the
 * largest coordinate keeps its square in the range of fp32. */
static const struct light_key {
    const char *name;
    size_t count;
    unsigned kinds;
    double min, max;
    const char *unit;
} keys[] = {
    [POSITION] = {"position", 3, POINT | SPOT, -1e18, 1e18, "scene units"},
    [DIRECTION] = {"direction", 3, DIRECTIONAL | SPOT, -1e18, 1e18, "a vector"},
    [COLOR] = {"color", 3, DIRECTIONAL | POINT | SPOT, 0, 1e6, "linear"},
    [INTENSITY] = {"intensity", 1, DIRECTIONAL | POINT | SPOT, 0, 1e24, "candela, or lux for a directional light"},
    [RADIUS] = {"radius", 1, DIRECTIONAL | POINT | SPOT, 0, 1e18, "scene units"},
    [INNER] = {"inner", 1, SPOT, 0, 90, "degrees"},
    [OUTER] = {"outer", 1, SPOT, 0, 90, "degrees"},
    [RANGE] = {"range", 1, POINT | SPOT, 0, 1e18, "scene units, 0: no limit"},
};

enum { KEY_COUNT = sizeof keys / sizeof keys[0] };

struct light light_default(enum light_kind kind)
{
    return (struct light){
        .kind = kind,
        .direction = {0, 0, -1},
        .color = {1, 1, 1},
        .intensity = 1,
        .inner = 0,
        .outer = kind == LIGHT_SPOT ? M_PI / 4 : 0,
    };
}

static const struct light_key *find_key(enum light_kind kind, const char *name, struct error *err)
{
    const char *accepted[KEY_COUNT + 1];
    size_t count = 0;
    for (size_t i = 0; i < KEY_COUNT; i++) {
        if (!(keys[i].kinds & 1u << kind))
            continue;
        if (!strcmp(keys[i].name, name))
            return &keys[i];
        accepted[count++] = keys[i].name;
    }
    accepted[count] = NULL;
    char list[160];
    name_list(accepted, list, sizeof list);
    error_set(err, ERROR_USAGE, "light", "a %s light has no '%.40s'; %s are accepted", light_kind_names[kind], name, list);
    return NULL;
}

size_t light_key_values(enum light_kind kind, const char *key, struct error *err)
{
    const struct light_key *k = find_key(kind, key, err);
    return k ? k->count : 0;
}

static bool check_range(const struct light_key *k, const double *values, struct error *err)
{
    bool good = true;
    for (size_t i = 0; i < k->count; i++)
        good = good && values[i] >= k->min && values[i] <= k->max;
    if (k == &keys[DIRECTION])
        good = good && (values[0] != 0 || values[1] != 0 || values[2] != 0);
    if (good)
        return true;
    return error_set(err, ERROR_USAGE, k->name, "%s is out of range; %s%g to %g (%s)%s accepted", k->name,
                     k->count == 3 ? "three numbers from " : "", k->min, k->max, k->unit,
                     k == &keys[DIRECTION] ? ", not all zero, are"
                     : k->count == 3       ? " are"
                                           : " is");
}

/* Scaled first, so that the length of a tiny or huge vector neither underflows nor overflows. */
static struct dvec3 unit(const double *v)
{
    double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    return dvec3_normalize(dvec3(v[0] / largest, v[1] / largest, v[2] / largest));
}

bool light_set(struct light *light, const char *key, const double *values, struct error *err)
{
    const struct light_key *k = find_key(light->kind, key, err);
    if (!k || !check_range(k, values, err))
        return false;
    switch ((enum property)(k - keys)) {
    case POSITION: light->position = dvec3(values[0], values[1], values[2]); break;
    case DIRECTION: light->direction = unit(values); break;
    case COLOR:
        for (int i = 0; i < 3; i++)
            light->color[i] = (float)values[i];
        break;
    case INTENSITY: light->intensity = (float)values[0]; break;
    case RADIUS: light->radius = values[0]; break;
    case INNER: light->inner = values[0] * (M_PI / 180); break;
    case OUTER: light->outer = values[0] * (M_PI / 180); break;
    case RANGE: light->range = values[0]; break;
    }
    return true;
}

bool light_check(const struct light *light, struct error *err)
{
    if (light->kind == LIGHT_SPOT && !(light->inner < light->outer))
        return error_set(err, ERROR_USAGE, "outer",
                         "a spot's inner half angle (%g degrees) must be less than its outer one (%g); outer is at most 90",
                         light->inner * (180 / M_PI), light->outer * (180 / M_PI));
    return true;
}

static bool parse_property(struct light *light, char *word, unsigned *seen, struct error *err)
{
    char *equals = strchr(word, '=');
    if (!equals)
        return error_set(err, ERROR_USAGE, "light", "'%.40s' is not key=value", word);
    *equals = 0;
    const struct light_key *k = find_key(light->kind, word, err);
    if (!k)
        return false;
    if (*seen & 1u << (k - keys))
        return error_set(err, ERROR_USAGE, "light", "%s is given twice", k->name);
    *seen |= 1u << (k - keys);
    double values[3];
    if (!number_parse_list(equals + 1, values, k->count))
        return error_set(err, ERROR_USAGE, k->name, "%s=%.40s is not understood; %s is accepted", k->name, equals + 1,
                         k->count == 3 ? "three finite numbers x,y,z" : "one finite number");
    return light_set(light, k->name, values, err);
}

bool light_parse(const char *text, struct light *out, struct error *err)
{
    char copy[512];
    if (strlen(text) >= sizeof copy)
        return error_set(err, ERROR_USAGE, "light", "the text is longer than %zu bytes", sizeof copy - 1);
    strcpy(copy, text);
    char *rest;
    char *word = strtok_r(copy, " \t\n", &rest);
    int kind = word ? name_index(light_kind_names, word) : -1;
    if (kind < 0)
        return error_set(err, ERROR_USAGE, "light",
                         "a light begins with its kind: point, spot or directional, then key=value words, such as "
                         "'point position=0,2,0 intensity=100'");
    struct light light = light_default((enum light_kind)kind);
    unsigned seen = 0;
    while ((word = strtok_r(NULL, " \t\n", &rest)))
        if (!parse_property(&light, word, &seen, err))
            return false;
    if (!light_check(&light, err))
        return false;
    *out = light;
    return true;
}

struct light light_from_world(const struct scene *scene, const struct light *light)
{
    struct light moved = *light;
    moved.position = dvec3_sub(light->position, scene->origin);
    return moved;
}
