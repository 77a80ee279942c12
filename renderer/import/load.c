#include <string.h>

#include "builtin/builtin.h"
#include "import/import.h"

struct scene *scene_load(const char *name, struct error *err)
{
    if (strncmp(name, "builtin:", 8) == 0)
        return builtin_make(name + 8, err);
    return import_gltf(name, NULL, err);
}
