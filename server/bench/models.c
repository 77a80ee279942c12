#include "models.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const struct model {
    const char *name;
    const char *files[3]; /* the first that is there counts */
    const char *builtin, *quick;
} models[] = {
    {"@dense",
     {"dragon/dragon-x3-ground.gltf", "dragon/dragon-ground.gltf", NULL},
     "builtin:dragon",
     "builtin:dragon:triangles=100000"},
    {"@butterfly", {"butterfly-ground.glb", NULL}, "builtin:butterfly", "builtin:butterfly"},
    {"@tree", {"tree-oak-geoleaf-ground.glb", NULL}, "builtin:tree", "builtin:tree"},
    {"@ball", {"ball-lattice-ground.glb", NULL}, "builtin:ball", "builtin:ball"},
};

static bool find_file(const struct model *m, const char *folder, char *out, size_t size)
{
    for (int i = 0; folder && m->files[i]; i++) {
        int n = snprintf(out, size, "%s/%s", folder, m->files[i]);
        if (n > 0 && (size_t)n < size && access(out, R_OK) == 0)
            return true;
    }
    return false;
}

bool model_resolve(const char *name, const char *folder, bool quick, char *out, size_t size)
{
    if (name[0] != '@')
        return snprintf(out, size, "%s", name) < (int)size;
    for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
        const struct model *m = &models[i];
        if (strcmp(m->name, name))
            continue;
        return (!quick && find_file(m, folder, out, size)) ||
               snprintf(out, size, "%s", quick ? m->quick : m->builtin) < (int)size;
    }
    return false;
}

const char *model_label(const char *scene)
{
    const char *slash = strncmp(scene, "builtin:", 8) ? strrchr(scene, '/') : NULL;
    return slash ? slash + 1 : scene;
}

static bool ends_in(const char *text, const char *end)
{
    size_t n = strlen(text), m = strlen(end);
    return n >= m && !strcmp(text + n - m, end);
}

bool model_is(const char *name, const char *scene)
{
    for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
        const struct model *m = &models[i];
        if (strcmp(m->name, name))
            continue;
        for (int f = 0; m->files[f]; f++)
            if (ends_in(scene, m->files[f]))
                return true;
        return !strcmp(scene, m->builtin) || !strcmp(scene, m->quick);
    }
    return !strcmp(name, scene);
}
