#include "listing_text.h"

#include <string.h>

#include "numbers.h"

static const char *text(const json_t *object, const char *name)
{
    const char *value = json_string_value(json_object_get(object, name));
    return value ? value : "";
}

static double number(const json_t *object, const char *name) { return json_number_value(json_object_get(object, name)); }
static bool flag(const json_t *object, const char *name) { return json_is_true(json_object_get(object, name)); }

static void print_range(const json_t *p, FILE *out)
{
    fprintf(out, "%.9g to %.9g, default %.9g", number(p, "min"), number(p, "max"), number(p, "default"));
}

static void print_choices(const json_t *p, FILE *out)
{
    enum { MOST = 16 };
    const char *names[MOST + 1] = {0};
    const json_t *choices = json_object_get(p, "choices");
    char list[160];
    size_t count = 0;
    for (size_t i = 0; i < json_array_size(choices) && count < MOST; i++)
        if (json_is_string(json_array_get(choices, i)))
            names[count++] = json_string_value(json_array_get(choices, i));
    name_list(names, list, sizeof list);
    fprintf(out, "%s, default %s", list, text(p, "default"));
}

void listing_print_scenes(const json_t *listing, FILE *out)
{
    size_t i, k;
    json_t *scene, *p;
    json_array_foreach((json_t *)listing, i, scene)
    {
        fprintf(out, "%s\n", text(scene, "name"));
        if (*text(scene, "help"))
            fprintf(out, "    %s\n", text(scene, "help"));
        json_array_foreach(json_object_get(scene, "params"), k, p)
        {
            fprintf(out, "    %-12s ", text(p, "name"));
            print_range(p, out);
            fprintf(out, "%s: %s\n", strcmp(text(p, "kind"), "int") == 0 ? ", whole" : "", text(p, "help"));
        }
    }
}

static void print_param(const json_t *p, FILE *out)
{
    fprintf(out, "    %-12s ", text(p, "name"));
    if (strcmp(text(p, "kind"), "choice") == 0) {
        print_choices(p, out);
    } else {
        print_range(p, out);
        fprintf(out, "%s%s%s", flag(p, "odd") ? ", odd" : "", *text(p, "unit") ? " " : "", text(p, "unit"));
    }
    fprintf(out, ": %s\n", text(p, "help"));
}

void listing_print_algorithms(const json_t *listing, FILE *out)
{
    size_t i, k;
    json_t *system, *p;
    json_array_foreach((json_t *)listing, i, system)
    {
        fprintf(out, "%s\n    %s: %s\n", text(system, "name"), text(system, "title"), text(system, "help"));
        json_array_foreach(json_object_get(system, "params"), k, p) print_param(p, out);
    }
}

void listing_print_devices(const json_t *listing, FILE *out)
{
    size_t i;
    json_t *d;
    json_array_foreach((json_t *)listing, i, d)
    {
        char index[16] = "-";
        if (json_is_integer(json_object_get(d, "index")))
            snprintf(index, sizeof index, "%d", (int)number(d, "index"));
        fprintf(out, "%-3s %-11s %-22s ", index, text(d, "platform"), *text(d, "node") ? text(d, "node") : "-");
        if (!flag(d, "usable"))
            fprintf(out, "not usable: %s\n", text(d, "why_not"));
        else
            fprintf(out, "%s, %s%s\n", text(d, "renderer"), text(d, "version"), flag(d, "software") ? " (software)" : "");
    }
}
