#include "passes/visibility.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "gl/context.h"
#include "passes/tiles.h"

static bool reserve(struct visibility *v, size_t floats, struct error *err)
{
    if (v->room >= floats)
        return true;
    free(v->memory);
    v->memory = malloc(floats * sizeof *v->memory);
    v->room = v->memory ? floats : 0;
    return v->memory ||
           error_set(err, ERROR_TRY_AGAIN, "size", "out of memory for the visibility of %zu pixels and lights", floats);
}

bool visibility_begin(struct visibility *v, struct gl_context *gl, uint32_t width, uint32_t height, uint32_t layers,
                      const struct tiles *tiles, bool keep, struct error *err)
{
    size_t pixels = (size_t)width * height;
    if (!gl_texture_size_layers(&v->texture, gl, GL_R32F, width, height, layers, err) ||
        (keep && !reserve(v, pixels * layers, err)))
        return false;
    v->top = tiles->top;
    v->bottom = tiles->bottom;
    for (uint32_t i = 0; i < layers; i++)
        v->layers[i] = (struct visibility_layer){.values = keep ? v->memory + i * pixels : NULL};
    return true;
}

void visibility_bind(struct visibility *v, uint32_t layer)
{
    static const GLfloat dark[4];
    gl_target_attach(&v->target, &v->texture, NULL, layer);
    gl_target_bind(&v->target, v->texture.width, v->texture.height);
    glClearNamedFramebufferfv(v->target.id, GL_COLOR, 0, dark);
}

bool visibility_need_texture(struct visibility *v, struct gl_context *gl, struct error *err)
{
    uint32_t width = v->texture.width;
    for (uint32_t i = 0; i < v->texture.layers; i++)
        if (v->layers[i].filled && v->top < v->bottom)
            glTextureSubImage3D(v->texture.id, 0, 0, (GLint)v->top, (GLint)i, (GLsizei)width, (GLsizei)(v->bottom - v->top), 1,
                                GL_RED, GL_FLOAT, v->layers[i].values + (size_t)v->top * width);
    return gl_check(gl, err);
}

/* Rows [top, bottom) of a layer. */
static bool read_device(const struct visibility *v, struct gl_context *gl, uint32_t layer, uint32_t top, uint32_t bottom,
                        float *out, struct error *err)
{
    uint32_t width = v->texture.width, rows = bottom - top;
    glGetTextureSubImage(v->texture.id, 0, 0, (GLint)top, (GLint)layer, (GLsizei)width, (GLsizei)rows, 1, GL_RED, GL_FLOAT,
                         (GLsizei)((size_t)width * rows * sizeof *out), out);
    return gl_check(gl, err);
}

bool visibility_need_values(struct visibility *v, struct gl_context *gl, struct error *err)
{
    for (uint32_t i = 0; i < v->texture.layers; i++) {
        if (v->layers[i].filled || v->top >= v->bottom)
            continue;
        if (!read_device(v, gl, i, v->top, v->bottom, v->layers[i].values + (size_t)v->top * v->texture.width, err))
            return false;
    }
    return true;
}

bool visibility_read(struct visibility *v, struct gl_context *gl, uint32_t layer, float *out)
{
    struct error err = {0};
    size_t width = v->texture.width, rows = v->top < v->bottom ? v->bottom - v->top : 0;
    if (layer >= v->texture.layers)
        return false;
    if (!v->layers[layer].filled)
        return read_device(v, gl, layer, 0, v->texture.height, out, &err);
    memset(out, 0, width * v->texture.height * sizeof *out);
    memcpy(out + v->top * width, v->layers[layer].values + v->top * width, rows * width * sizeof *out);
    return true;
}

void visibility_finish(struct visibility *v)
{
    gl_texture_finish(&v->texture);
    gl_target_finish(&v->target);
    free(v->memory);
    memset(v, 0, sizeof *v);
}
