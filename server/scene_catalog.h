/* Which scenes clients may ask for: the built-in ones, and the .gltf and .glb files below the folders given with --scenes, by their path
 * relative to that folder. A client never names a path of its own. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/array.h"

struct error;

struct catalog_file {
    char *name, *path; /* owned */
};

struct scene_catalog {
    ARRAY(struct catalog_file) files; /* sorted by name within each folder; a name's first entry counts */
};

void scene_catalog_finish(struct scene_catalog *catalog);

/* Adds what lies below `folder`, at most 8 levels down, symbolic links to folders not followed. ERROR_NO_INPUT, ERROR_IO. */
bool scene_catalog_add_folder(struct scene_catalog *catalog, const char *folder, struct error *err);

/* Adds one file under its base name. */
bool scene_catalog_add_file(struct scene_catalog *catalog, const char *path, struct error *err);

/* What scene_load() takes for a client's `name`; the result lasts as long as the catalog and `name`. ERROR_NO_INPUT when there is none. */
const char *scene_catalog_find(const struct scene_catalog *catalog, const char *name, struct error *err);

/* True for "builtin:...". */
bool scene_is_builtin(const char *name);
