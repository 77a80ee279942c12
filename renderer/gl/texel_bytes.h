/* Bytes of a texel of the internal formats in use. */
#pragma once

#include <epoxy/gl.h>
#include <stddef.h>

static inline size_t texel_bytes(GLenum format)
{
    switch (format) {
    case GL_RGBA32F:
    case GL_RGBA32UI: return 16;
    case GL_RGBA16F:
    case GL_RG32UI:
    case GL_RG32F: return 8;
    default: return 4;
    }
}
