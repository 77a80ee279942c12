#include "scene_store.h"

#include <assert.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "scene/scene.h"

struct scene_store {
    const struct scene_catalog *catalog;
    struct scene_entry *entries; /* network thread */
    size_t count, capacity;
    uint64_t uses;

    pthread_t loader;
    bool loader_started;
    pthread_mutex_t mutex;
    pthread_cond_t work;
    struct scene_entry *wanted, *finished; /* by `queued`; guarded */
    bool stopping;                         /* guarded */
    void (*done)(void *context);
    void *context;
};

static void append(struct scene_entry **list, struct scene_entry *entry)
{
    while (*list)
        list = &(*list)->queued;
    *list = entry;
    entry->queued = NULL;
}

static void *loader_main(void *argument)
{
    struct scene_store *store = argument;
    pthread_mutex_lock(&store->mutex);
    while (!store->stopping) {
        struct scene_entry *entry = store->wanted;
        if (!entry) {
            pthread_cond_wait(&store->work, &store->mutex);
            continue;
        }
        store->wanted = entry->queued;
        pthread_mutex_unlock(&store->mutex);
        entry->scene = scene_load(entry->source, &entry->err);
        pthread_mutex_lock(&store->mutex);
        append(&store->finished, entry);
        pthread_mutex_unlock(&store->mutex);
        store->done(store->context);
        pthread_mutex_lock(&store->mutex);
    }
    pthread_mutex_unlock(&store->mutex);
    return NULL;
}

struct scene_store *scene_store_create(const struct scene_catalog *catalog, size_t capacity, void (*done)(void *context),
                                       void *context, struct error *err)
{
    struct scene_store *store = calloc(1, sizeof *store);
    if (!store) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the scene store");
        return NULL;
    }
    store->catalog = catalog;
    store->capacity = capacity;
    store->done = done;
    store->context = context;
    pthread_mutex_init(&store->mutex, NULL);
    pthread_cond_init(&store->work, NULL);
    int failure = pthread_create(&store->loader, NULL, loader_main, store);
    if (failure) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "cannot start the scene loader thread: %s", strerror(failure));
        scene_store_destroy(store);
        return NULL;
    }
    store->loader_started = true;
    return store;
}

struct scene_entry *scene_store_stop(struct scene_store *store)
{
    if (!store->loader_started)
        return store->entries;
    pthread_mutex_lock(&store->mutex);
    store->stopping = true;
    pthread_cond_signal(&store->work);
    pthread_mutex_unlock(&store->mutex);
    pthread_join(store->loader, NULL);
    store->loader_started = false;
    return store->entries;
}

void scene_store_destroy(struct scene_store *store)
{
    if (!store)
        return;
    for (struct scene_entry *entry = scene_store_stop(store), *next; entry; entry = next) {
        next = entry->link;
        scene_entry_destroy(entry);
    }
    pthread_cond_destroy(&store->work);
    pthread_mutex_destroy(&store->mutex);
    free(store);
}

struct scene_entry *scene_entry_ref(struct scene_entry *entry)
{
    atomic_fetch_add(&entry->refs, 1);
    return entry;
}

void scene_entry_unref(struct scene_entry *entry)
{
    if (!entry)
        return;
    unsigned before = atomic_fetch_sub(&entry->refs, 1);
    assert(before > 0);
    (void)before;
}

void scene_entry_destroy(struct scene_entry *entry)
{
    if (!entry)
        return;
    assert(!entry->gpu);
    scene_destroy(entry->scene);
    free(entry->source);
    free(entry);
}

/* The least recently used entry that nobody holds and the loader is done with. */
static struct scene_entry **find_idle(struct scene_store *store)
{
    struct scene_entry **oldest = NULL;
    for (struct scene_entry **at = &store->entries; *at; at = &(*at)->link)
        if ((*at)->status != SCENE_LOADING && atomic_load(&(*at)->refs) == 0 &&
            (!oldest || (*at)->last_used < (*oldest)->last_used))
            oldest = at;
    return oldest;
}

static struct scene_entry *unlink_entry(struct scene_store *store, struct scene_entry **at)
{
    struct scene_entry *entry = *at;
    *at = entry->link;
    entry->link = NULL;
    store->count--;
    return entry;
}

static struct file_stamp stamp_of(const char *source)
{
    struct stat info;
    if (scene_is_builtin(source) || stat(source, &info) != 0)
        return (struct file_stamp){0};
    return (struct file_stamp){(int64_t)info.st_mtim.tv_sec * 1000000000 + info.st_mtim.tv_nsec, (int64_t)info.st_size};
}

static bool same_stamp(struct file_stamp a, struct file_stamp b) { return a.modified_ns == b.modified_ns && a.bytes == b.bytes; }

void scene_store_watch(struct scene_store *store, void (*changed)(void *context, const struct scene_entry *entry, bool removed),
                       void *context)
{
    for (struct scene_entry *entry = store->entries; entry; entry = entry->link) {
        if (entry->status == SCENE_LOADING || entry->stale)
            continue;
        struct file_stamp now = stamp_of(entry->source);
        entry->stale = !same_stamp(now, entry->loaded) && same_stamp(now, entry->seen);
        entry->seen = now;
        if (entry->stale)
            changed(context, entry, now.modified_ns == 0);
    }
}

static struct scene_entry *add_entry(struct scene_store *store, const char *name, const char *source, struct error *err)
{
    struct scene_entry *entry = calloc(1, sizeof *entry);
    if (!entry || !(entry->source = strdup(source))) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for another scene");
        free(entry);
        return NULL;
    }
    snprintf(entry->name, sizeof entry->name, "%s", name);
    entry->status = SCENE_LOADING;
    entry->loaded = entry->seen = stamp_of(source);
    entry->link = store->entries;
    store->entries = entry;
    store->count++;
    pthread_mutex_lock(&store->mutex);
    append(&store->wanted, entry);
    pthread_cond_signal(&store->work);
    pthread_mutex_unlock(&store->mutex);
    return entry;
}

static struct scene_entry *find(const struct scene_store *store, const char *name)
{
    for (struct scene_entry *entry = store->entries; entry; entry = entry->link)
        if (!entry->stale && strcmp(entry->name, name) == 0)
            return entry;
    return NULL;
}

struct scene_entry *scene_store_get(struct scene_store *store, const char *name, struct scene_entry **evicted, struct error *err)
{
    *evicted = NULL;
    struct scene_entry *entry = find(store, name);
    if (!entry) {
        if (strlen(name) >= SCENE_NAME_MAX) {
            error_set(err, ERROR_USAGE, "scene", "scene: the name is longer than %d bytes", SCENE_NAME_MAX - 1);
            return NULL;
        }
        const char *source = scene_catalog_find(store->catalog, name, err);
        if (!source)
            return NULL;
        if (store->count >= store->capacity) {
            struct scene_entry **idle = find_idle(store);
            if (!idle) {
                error_set(err, ERROR_TRY_AGAIN, "scene",
                          "scene: %zu scenes are in use, and this server keeps no more; close a view first", store->count);
                return NULL;
            }
            *evicted = unlink_entry(store, idle);
        }
        if (!(entry = add_entry(store, name, source, err)))
            return NULL;
    }
    entry->last_used = ++store->uses;
    return scene_entry_ref(entry);
}

bool scene_store_settle(struct scene_store *store)
{
    pthread_mutex_lock(&store->mutex);
    struct scene_entry *finished = store->finished;
    store->finished = NULL;
    pthread_mutex_unlock(&store->mutex);
    bool any = finished;
    for (; finished; finished = finished->queued)
        finished->status = finished->scene ? SCENE_READY : SCENE_FAILED;
    return any;
}

void scene_store_forget_failed(struct scene_store *store)
{
    for (struct scene_entry **at = &store->entries; *at;)
        if ((*at)->status == SCENE_FAILED && atomic_load(&(*at)->refs) == 0)
            scene_entry_destroy(unlink_entry(store, at));
        else
            at = &(*at)->link;
}
