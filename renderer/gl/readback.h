/* A ring of pixel buffers with fences: pixels come back without the GPU or the caller waiting for each other. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct gl_context;
struct gl_texture;

#define GL_READBACK_SLOTS 3

struct gl_readback {
    struct gl_readback_slot {
        unsigned buffer;
        size_t capacity, size; /* bytes */
        void *fence;           /* GLsync; NULL: free */
    } slots[GL_READBACK_SLOTS];
    unsigned first, count; /* oldest slot in use, slots in use */
};

/* Starts reading the bound framebuffer's colour attachment, width x height, as `format`/`type` of `pixel_bytes`. False when all slots are in
 * use (err untouched) or on error; then nothing is added to the ring. */
bool gl_readback_start(struct gl_readback *ring, struct gl_context *gl, uint32_t width, uint32_t height, unsigned format,
                       unsigned type, size_t pixel_bytes, struct error *err);

/* The oldest: copied to `out` (at least its size) and its slot freed. wait = false: false at once if the GPU is not done.
 * On error the slot is freed too, unless the device does not answer. */
bool gl_readback_finish_oldest(struct gl_readback *ring, struct gl_context *gl, bool wait, void *out, size_t size,
                               struct error *err);

void gl_readback_finish(struct gl_readback *ring);
