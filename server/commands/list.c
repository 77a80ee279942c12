#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "builtin/builtin.h"
#include "command.h"
#include "listings.h"
#include "numbers.h"
#include "options.h"
#include "output.h"

struct list_options {
    const char *json; /* NULL: text */
};

static bool set_json(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct list_options *)target)->json = value;
    return true;
}

static const struct option option_table[] = {
    {"json", "FILE", "write JSON; - is standard output", set_json},
    {"server", "URL", "ask a running server", NULL},
    {0},
};

static const struct syntax syntax = {
    .command = "list",
    .usage = "scenes|algorithms|devices [--json FILE]",
    .summary = "Lists the built-in scenes, the shadow systems or the devices that can render.",
    .operand = "WHAT",
    .options = option_table,
    .examples = "  gnomon list algorithms\n"
                "  gnomon list devices --json -\n",
};

static void print_range(double min, double max, double initial) { printf("%.9g to %.9g, default %.9g", min, max, initial); }

static void print_scenes(void)
{
    for (size_t i = 0; i < builtin_count; i++) {
        const struct builtin_desc *b = builtin_list[i];
        printf("builtin:%s\n    %s\n", b->name, b->help);
        for (const struct builtin_param *p = b->params; p && p->name; p++) {
            printf("    %-12s ", p->name);
            print_range(p->min, p->max, p->initial);
            printf("%s: %s\n", p->whole ? ", whole" : "", p->help);
        }
    }
    printf("A path to a .gltf or .glb file is a scene too.\n");
}

static void print_param(const struct param_desc *p)
{
    char names[160];
    printf("    %-12s ", p->name);
    if (p->kind == PARAM_CHOICE) {
        name_list(p->choices, names, sizeof names);
        printf("%s, default %s", names, p->choices[(size_t)p->initial]);
    } else {
        print_range(p->min, p->max, p->initial);
        printf("%s%s%s", p->odd ? ", odd" : "", p->unit[0] ? " " : "", p->unit);
    }
    printf(": %s\n", p->help);
}

static void print_algorithms(void)
{
    for (size_t i = 0; i < shadow_system_count; i++) {
        const struct shadow_system *s = shadow_systems[i];
        printf("%s\n    %s: %s\n", s->name, s->title, s->help);
        for (size_t p = 0; p < s->param_count; p++)
            print_param(&s->params[p]);
    }
}

static void print_devices(const struct device_info *devices, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct device_info *d = &devices[i];
        char index[16] = "-";
        if (d->index >= 0)
            snprintf(index, sizeof index, "%d", d->index);
        printf("%-3s %-11s %-22s ", index, d->platform, d->node[0] ? d->node : "-");
        if (d->why_not[0])
            printf("not usable: %s\n", d->why_not);
        else
            printf("%s, %s%s\n", d->renderer, d->version, d->software ? " (software)" : "");
    }
}

static int finish_text(void)
{
    struct error err = {0};
    return output_flush(&err) ? 0 : command_fail(&err);
}

static int finish_json(const char *path, const char *name, json_t *listing)
{
    struct error err = {0};
    json_t *root = json_pack("{s:s, s:o}", "version", GNOMON_VERSION, name, listing);
    return output_json(path, root, &err) ? 0 : command_fail(&err);
}

static int list_scenes(const struct list_options *options)
{
    if (options->json)
        return finish_json(options->json, "scenes", listing_scenes());
    print_scenes();
    return finish_text();
}

static int list_algorithms(const struct list_options *options)
{
    if (options->json)
        return finish_json(options->json, "algorithms", listing_algorithms());
    print_algorithms();
    return finish_text();
}

/* The list is printed even when nothing in it works: it says why. */
static int list_devices(const struct list_options *options)
{
    struct device_info devices[DEVICES_MAX];
    size_t count = renderer_list_devices(devices, DEVICES_MAX);
    int code;
    if (options->json) {
        code = finish_json(options->json, "devices", listing_devices(devices, count));
    } else {
        print_devices(devices, count);
        code = finish_text();
    }
    bool usable = false;
    for (size_t i = 0; i < count; i++)
        usable = usable || !devices[i].why_not[0];
    if (code != 0 || usable)
        return code;
    struct error err = {0};
    error_set(&err, ERROR_NO_DEVICE, "device", "none of %zu devices is usable; Mesa's software renderer (libegl-mesa0) would be",
              count);
    return command_fail(&err);
}

int command_list(int argc, char **argv)
{
    static const struct {
        const char *name;
        int (*run)(const struct list_options *options);
    } kinds[] = {{"scenes", list_scenes}, {"algorithms", list_algorithms}, {"devices", list_devices}};
    struct list_options options = {0};
    const char *what = NULL;
    int code = options_start(&syntax, argc, argv, &options, NULL, &what);
    if (code >= 0)
        return code;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (!strcmp(kinds[i].name, what))
            return kinds[i].run(&options);
    struct error err = {0};
    error_set(&err, ERROR_USAGE, "arguments", "cannot list '%.60s'; scenes, algorithms or devices are accepted", what);
    return command_fail(&err);
}
