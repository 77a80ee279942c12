#include "gl/texture.h"

#include <epoxy/gl.h>
#include <string.h>

#include "base/error.h"
#include "gl/context.h"
#include "gl/texel_bytes.h"

static bool make(struct gl_texture *t, struct gl_context *gl, unsigned format, uint32_t width, uint32_t height, uint32_t layers,
                 bool flat, struct error *err)
{
    if (t->id && t->format == format && t->width == width && t->height == height && t->layers == layers && t->flat == flat)
        return true;
    gl_texture_finish(t);
    if (width > (uint32_t)gl->caps.max_texture_size || height > (uint32_t)gl->caps.max_texture_size)
        return error_set(err, ERROR_USAGE, "size", "%u x %u is more than this device's textures hold: at most %d a side", width,
                         height, gl->caps.max_texture_size);
    glCreateTextures(flat ? GL_TEXTURE_2D : GL_TEXTURE_2D_ARRAY, 1, &t->id);
    if (flat)
        glTextureStorage2D(t->id, 1, format, (GLsizei)width, (GLsizei)height);
    else
        glTextureStorage3D(t->id, 1, format, (GLsizei)width, (GLsizei)height, (GLsizei)layers);
    if (!gl_check(gl, err)) {
        gl_texture_finish(t);
        return false;
    }
    glTextureParameteri(t->id, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(t->id, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTextureParameteri(t->id, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(t->id, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    t->format = format;
    t->width = width;
    t->height = height;
    t->layers = layers;
    t->flat = flat;
    t->bytes = texel_bytes(format) * width * height * layers;
    return gl_check(gl, err);
}

bool gl_texture_size(struct gl_texture *t, struct gl_context *gl, unsigned format, uint32_t width, uint32_t height,
                     struct error *err)
{
    return make(t, gl, format, width, height, 1, true, err);
}

bool gl_texture_size_layers(struct gl_texture *t, struct gl_context *gl, unsigned format, uint32_t width, uint32_t height,
                            uint32_t layers, struct error *err)
{
    return make(t, gl, format, width, height, layers, false, err);
}

void gl_texture_finish(struct gl_texture *t)
{
    glDeleteTextures(t->id != 0, &t->id);
    memset(t, 0, sizeof *t);
}

void gl_texture_bind(const struct gl_texture *t, unsigned unit) { glBindTextureUnit(unit, t->id); }

static void attach(GLuint framebuffer, GLenum point, const struct gl_texture *t, uint32_t layer)
{
    if (!t)
        glNamedFramebufferTexture(framebuffer, point, 0, 0);
    else if (t->flat)
        glNamedFramebufferTexture(framebuffer, point, t->id, 0);
    else
        glNamedFramebufferTextureLayer(framebuffer, point, t->id, 0, (GLint)layer);
}

void gl_target_attach(struct gl_target *target, const struct gl_texture *color, const struct gl_texture *depth, uint32_t layer)
{
    if (!target->id)
        glCreateFramebuffers(1, &target->id);
    attach(target->id, GL_COLOR_ATTACHMENT0, color, layer);
    attach(target->id, GL_COLOR_ATTACHMENT1, NULL, 0);
    attach(target->id, GL_DEPTH_ATTACHMENT, depth, layer);
    glNamedFramebufferDrawBuffer(target->id, color ? GL_COLOR_ATTACHMENT0 : GL_NONE);
    glNamedFramebufferReadBuffer(target->id, color ? GL_COLOR_ATTACHMENT0 : GL_NONE);
}

void gl_target_attach_two(struct gl_target *target, const struct gl_texture *first, const struct gl_texture *second)
{
    static const GLenum both[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    gl_target_attach(target, first, NULL, 0);
    attach(target->id, GL_COLOR_ATTACHMENT1, second, 0);
    glNamedFramebufferDrawBuffers(target->id, second ? 2 : 1, both);
}

void gl_target_bind(const struct gl_target *target, uint32_t width, uint32_t height)
{
    glBindFramebuffer(GL_FRAMEBUFFER, target->id);
    glViewport(0, 0, (GLsizei)width, (GLsizei)height);
}

void gl_target_finish(struct gl_target *target)
{
    glDeleteFramebuffers(target->id != 0, &target->id);
    target->id = 0;
}

void gl_draw_full_screen(void) { glDrawArrays(GL_TRIANGLES, 0, 3); }
