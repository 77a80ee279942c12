/* A scene on the GPU: what every pass reads it from. Only what the scene needs is made: no texture coordinates, colours or texels where there
 * are none, no index buffer before something is rasterized. Bindings: shaders/blocks.h. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gl/buffer.h"
#include "scene/scene.h"

struct error;
struct gl_context;

struct draw_scene {
    const struct scene *scene;
    struct gl_context *gl;
    struct gl_buffer vertices, triangles, instances, texcoords, colors, materials, textures, texels;
    struct gl_buffer indices;          /* element buffer; made by draw_scene_need_indices() */
    struct gl_buffer instance_numbers; /* 0, 1, 2, ...: a per-instance attribute, since 4.5 has no gl_BaseInstance */
    unsigned vertex_array;
    bool has_emission; /* some material emits light, is unlit, or has an occlusion texture */
    bool plain;        /* no textures, no emission: a struct pixel follows from a hit without sampling anything */
    size_t bytes;
};

/* `scene` must outlive it. */
bool draw_scene_init(struct draw_scene *d, struct gl_context *gl, const struct scene *scene, struct error *err);
void draw_scene_finish(struct draw_scene *d);

bool draw_scene_need_indices(struct draw_scene *d, struct error *err);

/* Binds every buffer to its texture unit. */
void draw_scene_bind(const struct draw_scene *d);
