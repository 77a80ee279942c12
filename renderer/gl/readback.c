#include "gl/readback.h"

#include <epoxy/gl.h>
#include <string.h>

#include "base/error.h"
#include "gl/context.h"

/* A frame takes milliseconds; a GPU that says nothing for this long is lost. A rasterizer on the CPU is not: it may take minutes over a
 * large picture, and cannot be lost. */
#define LOST_AFTER_NS 60000000000u

static bool reserve(struct gl_readback_slot *slot, struct gl_context *gl, size_t size, struct error *err)
{
    if (slot->capacity >= size)
        return true;
    glDeleteBuffers(slot->buffer != 0, &slot->buffer);
    glCreateBuffers(1, &slot->buffer);
    glNamedBufferStorage(slot->buffer, (GLsizeiptr)size, NULL, GL_CLIENT_STORAGE_BIT | GL_MAP_READ_BIT);
    bool ok = gl_check(gl, err);
    slot->capacity = ok ? size : 0;
    return ok;
}

bool gl_readback_start(struct gl_readback *ring, struct gl_context *gl, uint32_t width, uint32_t height, unsigned format,
                       unsigned type, size_t pixel_bytes, struct error *err)
{
    if (ring->count == GL_READBACK_SLOTS)
        return false;
    struct gl_readback_slot *slot = &ring->slots[(ring->first + ring->count) % GL_READBACK_SLOTS];
    slot->size = pixel_bytes * width * height;
    if (!reserve(slot, gl, slot->size, err))
        return false;
    glBindBuffer(GL_PIXEL_PACK_BUFFER, slot->buffer);
    glReadPixels(0, 0, (GLsizei)width, (GLsizei)height, format, type, NULL);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    if (!gl_check(gl, err))
        return false;
    slot->fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    ring->count++;
    return true;
}

bool gl_readback_finish_oldest(struct gl_readback *ring, struct gl_context *gl, bool wait, void *out, size_t size,
                               struct error *err)
{
    if (ring->count == 0)
        return false;
    struct gl_readback_slot *slot = &ring->slots[ring->first];
    GLenum state;
    do {
        state = glClientWaitSync(slot->fence, 0, wait ? LOST_AFTER_NS : 0);
    } while (state == GL_TIMEOUT_EXPIRED && wait && gl->caps.software);
    if (state == GL_TIMEOUT_EXPIRED && !wait)
        return false;
    if (state == GL_TIMEOUT_EXPIRED || state == GL_WAIT_FAILED) {
        gl->failed = true;
        return error_set(err, ERROR_TRY_AGAIN, NULL, "the GL device does not answer: it was lost");
    }
    const void *mapped = glMapNamedBufferRange(slot->buffer, 0, (GLsizeiptr)slot->size, GL_MAP_READ_BIT);
    if (mapped)
        memcpy(out, mapped, size < slot->size ? size : slot->size);
    glUnmapNamedBuffer(slot->buffer);
    glDeleteSync(slot->fence);
    slot->fence = NULL;
    ring->first = (ring->first + 1) % GL_READBACK_SLOTS;
    ring->count--;
    return gl_check(gl, err);
}

void gl_readback_finish(struct gl_readback *ring)
{
    for (unsigned i = 0; i < GL_READBACK_SLOTS; i++) {
        if (ring->slots[i].fence)
            glDeleteSync(ring->slots[i].fence);
        glDeleteBuffers(ring->slots[i].buffer != 0, &ring->slots[i].buffer);
    }
    memset(ring, 0, sizeof *ring);
}
