#include <stddef.h>

#include "methods/methods.h"
#include "scene_store.h"
#include "wire.h"

struct scene_params {
    const char *scene;
};

static const struct member scene_members[] = {
    {"scene", MEMBER_STRING, offsetof(struct scene_params, scene), .max = SCENE_NAME_MAX - 1, .required = true},
    {0},
};

static enum outcome describe(struct server *server, struct call *call, const void *params, struct given given, json_t **result,
                             struct error *err)
{
    const struct scene_params *p = params;
    struct scene_entry *entry;
    (void)given;
    enum outcome outcome = dispatch_scene(server, call, p->scene, &entry, err);
    if (outcome != OUTCOME_DONE)
        return outcome;
    *result = wire_scene(entry->name, entry->scene);
    scene_entry_unref(entry);
    return OUTCOME_DONE;
}

const struct method method_scene_load = {"scene.load", scene_members, sizeof(struct scene_params), true, describe};
const struct method method_scene_describe = {"scene.describe", scene_members, sizeof(struct scene_params), false, describe};
