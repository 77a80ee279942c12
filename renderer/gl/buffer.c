#include "gl/buffer.h"

#include <epoxy/gl.h>

#include "base/error.h"
#include "gl/context.h"
#include "gl/texel_bytes.h"

static bool make(struct gl_buffer *b, struct gl_context *gl, size_t size, unsigned texel_format, struct error *err)
{
    gl_buffer_finish(b);
    if (texel_format && size / texel_bytes(texel_format) > (size_t)gl->caps.max_texture_buffer)
        return error_set(err, ERROR_TRY_AGAIN, NULL,
                         "the scene needs a buffer of %zu bytes; this device reads at most %zu in one", size,
                         (size_t)gl->caps.max_texture_buffer * texel_bytes(texel_format));
    glCreateBuffers(1, &b->id);
    glNamedBufferStorage(b->id, (GLsizeiptr)size, NULL, GL_DYNAMIC_STORAGE_BIT);
    if (texel_format) {
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &b->texture);
        glTextureBuffer(b->texture, texel_format, b->id);
    }
    if (!gl_check(gl, err)) {
        gl_buffer_finish(b);
        return false;
    }
    b->size = size;
    return true;
}

bool gl_buffer_set(struct gl_buffer *b, struct gl_context *gl, const void *data, size_t size, unsigned texel_format,
                   struct error *err)
{
    if ((!b->id || b->size < size) && !make(b, gl, size ? size : 16, texel_format, err))
        return false;
    if (data && size)
        glNamedBufferSubData(b->id, 0, (GLsizeiptr)size, data);
    return gl_check(gl, err);
}

void gl_buffer_finish(struct gl_buffer *b)
{
    glDeleteTextures(b->texture != 0, &b->texture);
    glDeleteBuffers(b->id != 0, &b->id);
    b->id = b->texture = 0;
    b->size = 0;
}

void gl_buffer_bind_texture(const struct gl_buffer *b, unsigned unit) { glBindTextureUnit(unit, b->texture); }
