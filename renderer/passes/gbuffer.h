/* What the camera sees, pixel by pixel: ids and receivers. Product of the camera pass, whichever producer ran; everything behind it sees only
 * this. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "draw/draw_view.h"
#include "gl/buffer.h"
#include "gl/texture.h"
#include "scene/view.h"

struct draw_scene;
struct error;
struct gl_context;
struct job_pool;
struct tracer;

struct gbuffer {
    struct draw_view view;         /* the camera */
    struct gl_buffer view_block;
    struct gl_texture ids;         /* R32UI */
    struct gl_texture receivers;   /* RGBA32F */
    struct gl_texture depth;       /* D32F; made when rasterizing */
    struct gl_target target;
    uint32_t *cpu_ids;             /* width * height; valid if traced, else filled on request */
    float *cpu_receivers;          /* width * height * 4; made when tracing */
    size_t cpu_pixels;             /* what these two have room for */
    bool traced;                   /* the last picture's producer */
};

/* Sizes everything for `view` and uploads its blocks. */
bool gbuffer_begin(struct gbuffer *g, struct draw_scene *scene, const struct view *view, unsigned light_count, struct error *err);
void gbuffer_finish(struct gbuffer *g);

/* Binds view block, ids, receivers, rows and the scene for a full-screen pass. */
void gbuffer_bind(const struct gbuffer *g, const struct draw_scene *scene);

/* The ids in CPU memory, reading them back (and waiting) if they were rasterized. NULL on error. */
const uint32_t *gbuffer_read_ids(struct gbuffer *g, struct gl_context *gl, struct error *err);
