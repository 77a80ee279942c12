#include "scene_catalog.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/error.h"

#define DEPTH_MAX 8
#define FILES_MAX 10000

bool scene_is_builtin(const char *name) { return strncmp(name, "builtin:", 8) == 0; }

void scene_catalog_finish(struct scene_catalog *catalog)
{
    for (size_t i = 0; i < catalog->files.count; i++) {
        free(catalog->files.data[i].name);
        free(catalog->files.data[i].path);
    }
    array_finish(&catalog->files);
}

static char *join(const char *a, const char *b)
{
    char *out = NULL;
    if (asprintf(&out, "%s%s%s", a, *a ? "/" : "", b) < 0)
        return NULL;
    return out;
}

static bool is_scene_file(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot && dot != name && (strcasecmp(dot, ".gltf") == 0 || strcasecmp(dot, ".glb") == 0);
}

/* Takes both strings over. */
static bool push(struct scene_catalog *catalog, char *name, char *path, struct error *err)
{
    if (name && path && array_push(&catalog->files, ((struct catalog_file){name, path})))
        return true;
    free(name);
    free(path);
    return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the list of scenes");
}

static bool add_below(struct scene_catalog *catalog, const char *folder, const char *prefix, unsigned depth, struct error *err);

static bool add_entry(struct scene_catalog *catalog, const char *folder, const char *prefix, const char *entry, unsigned depth,
                      struct error *err)
{
    char *path = join(folder, entry), *name = join(prefix, entry);
    struct stat info;
    bool ok = true, keep = false;
    if (!path || !name)
        ok = error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the list of scenes");
    else if (lstat(path, &info) == 0 && S_ISDIR(info.st_mode))
        ok = depth >= DEPTH_MAX || add_below(catalog, path, name, depth + 1, err);
    else
        keep = is_scene_file(entry) && stat(path, &info) == 0 && S_ISREG(info.st_mode) && catalog->files.count < FILES_MAX;
    if (keep)
        return push(catalog, name, path, err);
    free(path);
    free(name);
    return ok;
}

static bool add_below(struct scene_catalog *catalog, const char *folder, const char *prefix, unsigned depth, struct error *err)
{
    struct dirent **entries;
    int count = scandir(folder, &entries, NULL, alphasort);
    if (count < 0)
        return depth > 0 || error_set(err, errno == ENOENT || errno == ENOTDIR ? ERROR_NO_INPUT : ERROR_IO, "--scenes",
                                      "--scenes %s: %s; a readable folder is wanted", folder, strerror(errno));
    bool ok = true;
    for (int i = 0; i < count; i++) {
        if (ok && entries[i]->d_name[0] != '.')
            ok = add_entry(catalog, folder, prefix, entries[i]->d_name, depth, err);
        free(entries[i]);
    }
    free(entries);
    return ok;
}

bool scene_catalog_add_folder(struct scene_catalog *catalog, const char *folder, struct error *err)
{
    return add_below(catalog, folder, "", 0, err);
}

bool scene_catalog_add_file(struct scene_catalog *catalog, const char *path, struct error *err)
{
    const char *slash = strrchr(path, '/');
    return push(catalog, strdup(slash ? slash + 1 : path), strdup(path), err);
}

const char *scene_catalog_find(const struct scene_catalog *catalog, const char *name, struct error *err)
{
    if (scene_is_builtin(name))
        return name;
    for (size_t i = 0; i < catalog->files.count; i++)
        if (strcmp(catalog->files.data[i].name, name) == 0)
            return catalog->files.data[i].path;
    error_set(err, ERROR_NO_INPUT, "scene",
              "scene: this server has no scene \"%s\"; server.hello lists the names, and builtin:NAME is always there", name);
    return NULL;
}
