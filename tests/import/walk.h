/* Every .gltf and .glb below a folder, in a fixed order. */
#pragma once

#include <fts.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static inline int by_name(const FTSENT **a, const FTSENT **b) { return strcmp((*a)->fts_name, (*b)->fts_name); }

static inline int is_gltf(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot && (strcmp(dot, ".gltf") == 0 || strcmp(dot, ".glb") == 0);
}

/* Calls each(path, path below the folder); returns how many there were. */
static inline unsigned walk(const char *folder, void (*each)(const char *path, const char *below))
{
    char *const roots[] = {(char *)folder, NULL};
    FTS *tree = fts_open(roots, FTS_PHYSICAL | FTS_NOCHDIR, by_name);
    unsigned count = 0;
    for (FTSENT *entry; tree && (entry = fts_read(tree));) {
        if (entry->fts_info != FTS_F || !is_gltf(entry->fts_name))
            continue;
        each(entry->fts_path, entry->fts_path + strlen(folder) + 1);
        count++;
    }
    if (tree)
        fts_close(tree);
    return count;
}
