/* A renderer in a test, and pictures taken with it. Whatever fails here fails the test. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "renderer.h"

struct studio {
    struct job_pool *pool;
    struct renderer *renderer;
};

/* False, having said why, when there is no device: the caller exits 77. The folders are as in struct renderer_options. */
bool studio_open(struct studio *studio, const char *shader_dir, const char *cache_dir);
void studio_close(struct studio *studio);

/* A scene before the camera. */
struct set {
    struct scene *scene; /* owned */
    struct render_scene *uploaded;
    struct render_settings settings; /* small, both producers rasterized, aa 1; to be changed at will */
};

/* `scene` is taken over. */
struct set set_build(struct studio *studio, struct scene *scene);
struct set set_load(struct studio *studio, const char *name);
void set_strike(struct set *set);

/* "NAME:key=value,..." */
void set_use(struct set *set, const char *algorithm);

struct shot {
    uint32_t width, height;
    uint8_t *pixels;                        /* RGBA8, or RGBA32F by settings.format */
    size_t size;                            /* of pixels, bytes */
    uint32_t *ids;                          /* aa 1 only, else NULL */
    float *visibility[RENDERER_LIGHTS_MAX]; /* likewise; one a light */
    size_t light_count;
    struct frame_info info;
};

/* As many frames as a progressive system needs; info.prepared: some of them prepared something. */
struct shot shot_take(struct studio *studio, struct set *set);
void shot_drop(struct shot *shot);

/* The same bits: picture, ids and visibility. */
bool shot_same(const struct shot *a, const struct shot *b);

/* The truth about `light` for the shot's own ids (reference_point). Both are malloc'd, width * height. */
void shot_truth(const struct studio *studio, const struct set *set, const struct shot *shot, unsigned light, float **visibility,
                uint8_t **receiver);
