#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "command.h"
#include "listing_text.h"
#include "listings.h"
#include "options.h"
#include "output.h"
#include "remote.h"

struct list_options {
    const char *json; /* NULL: text */
    struct remote remote;
};

static bool set_json(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct list_options *)target)->json = value;
    return true;
}

static bool set_server(void *target, const char *value, struct error *err)
{
    return remote_set_url(&((struct list_options *)target)->remote, value, err);
}

static bool set_token_file(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct list_options *)target)->remote.token_file = value;
    return true;
}

static const struct option option_table[] = {
    {"json", "FILE", "write JSON; - is standard output", set_json},
    {"server", "URL", "what the server at http://HOST:PORT/ offers, and the device that it renders on", set_server},
    {"token-file", "FILE", REMOTE_OPTION_TOKEN, set_token_file},
    {0},
};

static const struct syntax syntax = {
    .command = "list",
    .usage = "scenes|algorithms|devices [--json FILE] [--server URL]",
    .summary = "Lists the built-in scenes, the shadow systems or the devices that can render; or a server's.",
    .operand = "WHAT",
    .options = option_table,
    .examples = "  gnomon list algorithms\n"
                "  gnomon list devices --json -\n"
                "  gnomon list scenes --server http://127.0.0.1:8080/\n",
};

static json_t *local_devices(void)
{
    struct device_info devices[DEVICES_MAX];
    return listing_devices(devices, renderer_list_devices(devices, DEVICES_MAX));
}

static const struct kind {
    const char *name, *path;
    json_t *(*local)(void);
    void (*print)(const json_t *listing, FILE *out);
    const char *note; /* after the text, where this machine's is listed; may be NULL */
} kinds[] = {
    {"scenes", "/v1/scenes", listing_scenes, listing_print_scenes, "A path to a .gltf or .glb file is a scene too.\n"},
    {"algorithms", "/v1/algorithms", listing_algorithms, listing_print_algorithms, NULL},
    {"devices", "/v1/devices", local_devices, listing_print_devices, NULL},
};

static const struct kind *find_kind(const char *name, struct error *err)
{
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (!strcmp(kinds[i].name, name))
            return &kinds[i];
    error_set(err, ERROR_USAGE, "arguments", "cannot list '%.60s'; scenes, algorithms or devices are accepted", name);
    return NULL;
}

static json_t *get(const struct kind *kind, const struct remote *remote, struct error *err)
{
    if (remote->url)
        return remote_list(remote, kind->path, kind->name, err);
    if (remote->token_file) {
        error_set(err, ERROR_USAGE, "token-file", "--token-file is accepted only with --server");
        return NULL;
    }
    json_t *listing = kind->local();
    if (!listing)
        error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for a list");
    return listing;
}

/* Takes no reference. */
static bool write(const struct kind *kind, const struct list_options *options, json_t *listing, struct error *err)
{
    if (options->json)
        return output_json(options->json, json_pack("{s:s, s:O}", "version", GNOMON_VERSION, kind->name, listing), err);
    kind->print(listing, stdout);
    if (kind->note && !options->remote.url)
        fputs(kind->note, stdout);
    return output_flush(err);
}

/* The list is printed even when nothing in it works: it says why. */
static bool check_usable(const struct kind *kind, const json_t *listing, struct error *err)
{
    size_t i;
    json_t *device;
    bool usable = kind->local != local_devices;
    json_array_foreach((json_t *)listing, i, device) usable = usable || json_is_true(json_object_get(device, "usable"));
    return usable ||
           error_set(err, ERROR_NO_DEVICE, "device",
                     "none of %zu devices is usable; Mesa's software renderer (libegl-mesa0) would be", json_array_size(listing));
}

int command_list(int argc, char **argv)
{
    struct list_options options = {0};
    struct error err = {0};
    const char *what = NULL;
    int code = options_start(&syntax, argc, argv, &options, NULL, &what);
    if (code >= 0)
        return code;
    const struct kind *kind = find_kind(what, &err);
    json_t *listing = kind ? get(kind, &options.remote, &err) : NULL;
    bool good = listing && write(kind, &options, listing, &err) && check_usable(kind, listing, &err);
    json_decref(listing);
    return good ? 0 : command_fail(&err);
}
