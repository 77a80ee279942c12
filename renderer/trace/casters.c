/* Trees over a part of the scene, kept: a light asks for the same casters in every frame. */
#include <stdlib.h>
#include <string.h>

#include "trace/tree.h"

struct caster_tree {
    RTCScene scene;
    uint32_t *casters;
    size_t count;
    struct caster_tree *next;
};

struct caster_cache {
    pthread_mutex_t mutex;
    struct caster_tree *trees;
};

struct caster_cache *caster_cache_create(void)
{
    struct caster_cache *cache = calloc(1, sizeof *cache);
    if (cache)
        pthread_mutex_init(&cache->mutex, NULL);
    return cache;
}

static void caster_tree_destroy(struct caster_tree *tree)
{
    if (!tree)
        return;
    if (tree->scene)
        rtcReleaseScene(tree->scene);
    free(tree->casters);
    free(tree);
}

void caster_cache_destroy(struct caster_cache *cache)
{
    if (!cache)
        return;
    while (cache->trees) {
        struct caster_tree *next = cache->trees->next;
        caster_tree_destroy(cache->trees);
        cache->trees = next;
    }
    pthread_mutex_destroy(&cache->mutex);
    free(cache);
}

static struct caster_tree *caster_tree_create(const struct tracer *t, const uint32_t *casters, size_t count)
{
    struct caster_tree *tree = calloc(1, sizeof *tree);
    if (!tree)
        return NULL;
    tree->casters = malloc(count ? count * sizeof *casters : 1);
    tree->scene = tree->casters ? rtcNewScene(t->device) : NULL;
    if (!tree->scene) {
        caster_tree_destroy(tree);
        return NULL;
    }
    memcpy(tree->casters, casters, count * sizeof *casters);
    tree->count = count;
    rtcSetSceneFlags(tree->scene, RTC_SCENE_FLAG_ROBUST);
    for (size_t i = 0; i < count; i++)
        if (t->geometries[casters[i]])
            rtcAttachGeometryByID(tree->scene, t->geometries[casters[i]], casters[i]);
    rtcCommitScene(tree->scene);
    if (rtcGetDeviceError(t->device) != RTC_ERROR_NONE) {
        caster_tree_destroy(tree);
        return NULL;
    }
    return tree;
}

RTCScene tree_of_casters(const struct tracer *t, const uint32_t *casters, size_t count)
{
    if (!casters)
        return t->all;
    pthread_mutex_lock(&t->casters->mutex);
    struct caster_tree *tree = t->casters->trees;
    while (tree && (tree->count != count || memcmp(tree->casters, casters, count * sizeof *casters) != 0))
        tree = tree->next;
    if (!tree && (tree = caster_tree_create(t, casters, count))) {
        tree->next = t->casters->trees;
        t->casters->trees = tree;
    }
    pthread_mutex_unlock(&t->casters->mutex);
    return tree ? tree->scene : NULL;
}
