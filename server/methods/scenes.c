#include "methods/methods.h"
#include "scene_store.h"
#include "wire.h"

static enum outcome describe(struct server *server, struct call *call, const struct params *p, json_t **result, struct error *err)
{
    struct scene_entry *entry;
    enum outcome outcome = dispatch_scene(server, call, p->scene, &entry, err);
    if (outcome != OUTCOME_DONE)
        return outcome;
    *result = wire_scene(entry->name, entry->scene);
    scene_entry_unref(entry);
    return OUTCOME_DONE;
}

enum outcome method_scene_load(struct server *server, struct call *call, const struct params *p, struct given given,
                               json_t **result, struct error *err)
{
    (void)given;
    return describe(server, call, p, result, err);
}

enum outcome method_scene_describe(struct server *server, struct call *call, const struct params *p, struct given given,
                                   json_t **result, struct error *err)
{
    (void)given;
    return describe(server, call, p, result, err);
}
