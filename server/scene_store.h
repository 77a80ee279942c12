/* Scenes in memory, by name, loaded on a thread of their own. Owned by the network thread; what other threads may call says so. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "scene_catalog.h"

struct render_scene;
struct scene;

#define SCENE_NAME_MAX 256 /* bytes, with the terminator */

enum scene_status { SCENE_LOADING, SCENE_READY, SCENE_FAILED };

/* What tells one state of a file from another; all zero where there is none. */
struct file_stamp {
    int64_t modified_ns;
    int64_t bytes;
};

struct scene_entry {
    struct scene_entry *link; /* in the store, or in a list handed out */
    char name[SCENE_NAME_MAX];
    char *source;                   /* what scene_load() takes */
    enum scene_status status;       /* network thread */
    struct scene *scene;            /* frozen; valid once READY */
    struct error err;               /* valid once FAILED */
    _Atomic unsigned refs;          /* holders beside the store; rises from 0 on the network thread only */
    uint64_t last_used;             /* network thread: order of use */
    struct render_scene *gpu;       /* render thread */
    bool gpu_failed;                /* render thread */
    struct scene_entry *queued;     /* the loader's lists */
    struct file_stamp loaded, seen; /* network thread: of the source when it was asked for, and at the last watch */
    bool stale;                     /* network thread: the source has changed; not found by name any more */
};

struct scene_store;

/* At most `capacity` scenes are kept. `done` is called on the loader thread after each load. */
struct scene_store *scene_store_create(const struct scene_catalog *catalog, size_t capacity, void (*done)(void *context),
                                       void *context, struct error *err);
/* Ends the loader thread, once its present load is through, and returns all entries, linked, still the store's. */
struct scene_entry *scene_store_stop(struct scene_store *store);
/* Stops it. Entries must be unreferenced, and without a render_scene. Accepts NULL. */
void scene_store_destroy(struct scene_store *store);

/* The entry of `name`, loading if it is new, with one reference for the caller. Returns NULL with ERROR_NO_INPUT (no such name) or
 * ERROR_TRY_AGAIN (as many scenes in use as may be). *evicted: an entry that had to make room, to be passed to the render thread and
 * then to scene_entry_destroy(); or NULL. */
struct scene_entry *scene_store_get(struct scene_store *store, const char *name, struct scene_entry **evicted, struct error *err);

struct scene_entry *scene_entry_ref(struct scene_entry *entry); /* any thread, by a holder */
void scene_entry_unref(struct scene_entry *entry);              /* any thread; accepts NULL */
void scene_entry_destroy(struct scene_entry *entry);            /* render thread, once evicted; accepts NULL */

/* Notes finished loads in their entries' status; true when there were any. */
bool scene_store_settle(struct scene_store *store);

/* Calls `changed` for each scene whose file is not the one loaded any more, once that has been so for two calls in a row (a file may be in the
 * middle of being written). The next scene_store_get() loads it anew; whoever holds the entry keeps it. */
void scene_store_watch(struct scene_store *store, void (*changed)(void *context, const struct scene_entry *entry, bool removed),
                       void *context);

/* Forgets failed loads nobody holds, so that the next request tries again. */
void scene_store_forget_failed(struct scene_store *store);
