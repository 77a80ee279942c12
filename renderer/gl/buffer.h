/* Buffers, with a view as a texture where shaders read them by texelFetch. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct gl_context;

struct gl_buffer {
    unsigned id, texture; /* texture: 0 if it has no view */
    size_t size;          /* bytes */
};

/* Makes (or remakes when smaller) a buffer of at least `size` bytes and writes `data` (may be NULL) to its start. `texel_format`: GL internal
 * format of the view, 0 for none. A view over more texels than the device allows is an error. */
bool gl_buffer_set(struct gl_buffer *b, struct gl_context *gl, const void *data, size_t size, unsigned texel_format,
                   struct error *err);
void gl_buffer_finish(struct gl_buffer *b);
void gl_buffer_bind_texture(const struct gl_buffer *b, unsigned unit);
