#include <string.h>

#include "methods/methods.h"

const struct method *const methods[] = {
    &method_scene_load,
    &method_scene_describe,
    &method_view_open,
    &method_view_set,
    &method_view_close,
    &method_light_add,
    &method_light_set,
    &method_light_remove,
    &method_frame_ack,
    &method_render_snapshot,
    NULL,
};

const struct method *method_find(const char *name)
{
    for (size_t i = 0; methods[i]; i++)
        if (strcmp(methods[i]->name, name) == 0)
            return methods[i];
    return NULL;
}
