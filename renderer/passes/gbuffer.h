/* What the camera sees, pixel by pixel: product of the camera pass, whichever producer ran. The id names the triangle; the pixel
 * (scene/pixel.h) is what that triangle says at the pixel's centre. Everything behind sees only this. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "draw/draw_view.h"
#include "gl/buffer.h"
#include "gl/texture.h"
#include "passes/tiles.h"
#include "scene/view.h"

struct draw_scene;
struct error;
struct gl_context;
struct pixel;

struct gbuffer {
    struct draw_view view; /* the camera */
    struct gl_buffer view_block;
    struct gl_texture ids;      /* R32UI; of a traced picture only after gbuffer_need_ids() */
    struct gl_texture pixels;   /* RGBA32UI: struct pixel */
    struct gl_texture emission; /* RGBA16F; made for scenes that have some */
    struct gl_texture depth;    /* D32F; made when rasterizing */
    struct tiles tiles;         /* where there are surfaces; full-screen passes draw these */
    struct gl_target target;
    uint32_t *cpu_ids;         /* width * height; valid if traced, else filled on request */
    struct pixel *cpu_pixels;  /* width * height; made when tracing */
    size_t cpu_room;           /* pixels that these two have room for */
    struct pixel *read_pixels; /* width * height; made when asked for */
    size_t read_room;
    float *values; /* scratch, likewise */
    size_t value_room;
    bool pixels_read;     /* read_pixels is the last picture's */
    bool traced;          /* the last picture's producer */
    bool ids_uploaded;    /* ids is the last picture's */
    bool pixels_done;     /* they are the last picture's, be it in pixels or in cpu_pixels */
    bool pixels_uploaded; /* pixels has them */
};

/* Sizes everything for `view` and uploads its blocks. */
bool gbuffer_begin(struct gbuffer *g, struct draw_scene *scene, const struct view *view, struct error *err);
void gbuffer_finish(struct gbuffer *g);

/* Binds view block, ids, pixels, emission, rows and the scene for a full-screen pass; traced pixels go to the device now. */
void gbuffer_bind(struct gbuffer *g, const struct draw_scene *scene);

/* Makes ids valid on the GPU. */
bool gbuffer_need_ids(struct gbuffer *g, struct gl_context *gl, struct error *err);

/* The ids in CPU memory, reading them back (and waiting) if they were rasterized. NULL on error. */
const uint32_t *gbuffer_read_ids(struct gbuffer *g, struct gl_context *gl, struct error *err);

/* The same for the pixels. */
const struct pixel *gbuffer_read_pixels(struct gbuffer *g, struct draw_scene *scene, struct error *err);

/* Scratch of a float a pixel, for whoever makes one light's visibility on the CPU. NULL on error. */
float *gbuffer_values(struct gbuffer *g, struct error *err);
