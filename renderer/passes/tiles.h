/* The parts of a picture that hold surfaces: full-screen passes need not visit the sky, which is a third of many pictures.
 *
 * Squares of 64 pixels, as llvmpipe's own, joined to rectangles; each is drawn as the full-screen triangle under a scissor, since the
 * diagonal of a quad would make every tile it crosses a partly covered one. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct job_pool;

struct tiles {
    struct tile_rectangle {
        uint32_t x, y, width, height; /* pixels */
    } * rectangles;                   /* owned */
    uint32_t count, capacity;
    uint32_t top, bottom; /* pixel rows they lie in: [top, bottom) */
};

/* The whole picture. */
bool tiles_set_all(struct tiles *t, uint32_t width, uint32_t height, struct error *err);

/* What of `ids` (width * height; SCENE_NONE: background) holds surfaces. */
bool tiles_set_occupied(struct tiles *t, const uint32_t *ids, uint32_t width, uint32_t height, struct job_pool *pool,
                        struct error *err);

/* Draws them with the program in use, whose vertex stage is full_screen.vert; any vertex array will do. */
void tiles_draw(const struct tiles *t, uint32_t vertex_array);
void tiles_finish(struct tiles *t);
