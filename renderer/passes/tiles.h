/* The parts of a picture that hold surfaces, as rectangles to draw: full-screen passes need not visit the sky. On a software rasterizer
 * that is a third of many pictures. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "gl/buffer.h"

struct error;
struct gl_context;
struct job_pool;

struct tiles {
    struct gl_buffer rectangles; /* a vec4 each: clip-space x0, y0, x1, y1 */
    unsigned vertex_array;
    uint32_t count;
    uint32_t top, bottom;        /* pixel rows they lie in: [top, bottom) */
};

/* The whole picture. */
bool tiles_set_all(struct tiles *t, struct gl_context *gl, uint32_t height, struct error *err);

/* What of `ids` (width * height; SCENE_NONE: background) holds surfaces, in squares of 64 pixels, joined along rows. */
bool tiles_set_occupied(struct tiles *t, struct gl_context *gl, const uint32_t *ids, uint32_t width, uint32_t height,
                        struct job_pool *pool, struct error *err);

/* Draws them with the program in use, whose vertex stage is tiles.vert. */
void tiles_draw(const struct tiles *t);
void tiles_finish(struct tiles *t);
