#include "shadow/pixel_pass.h"

#include <epoxy/gl.h>
#include <string.h>

#include "gl/context.h"
#include "passes/gbuffer.h"
#include "passes/visibility.h"

void pixel_put(float out[3], struct dvec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

struct pixel_light pixel_light_of(const struct light *light, struct dvec3 camera_eye)
{
    bool parallel = light->kind == LIGHT_DIRECTIONAL;
    struct pixel_light l = {.kind = light->kind,
                            .cosine = (float)cos(light->outer),
                            .range2 = parallel || light->range == 0 ? INFINITY : (float)(light->range * light->range)};
    pixel_put(l.light, parallel ? dvec3_neg(light->direction) : dvec3_sub(light->position, camera_eye));
    pixel_put(l.axis, light->direction);
    return l;
}

float *pixel_values(const struct shadow_input *in, struct error *err)
{
    return in->layer && in->layer->values ? in->layer->values : gbuffer_values(in->gbuffer, err);
}

/* Where the layer stays on the device, its texture is what the framework bound. */
bool pixel_upload(const struct shadow_input *in, const float *visibility, struct error *err)
{
    const struct tiles *t = &in->gbuffer->tiles;
    size_t first = (size_t)t->top * in->view->width, rows = t->top < t->bottom ? t->bottom - t->top : 0;
    if (in->layer && in->layer->values) {
        if (visibility != in->layer->values)
            memcpy(in->layer->values + first, visibility + first, rows * in->view->width * sizeof *visibility);
        in->layer->filled = true;
        return true;
    }
    GLint texture, layer;
    glGetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME,
                                          &texture);
    glGetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LAYER,
                                          &layer);
    if (rows)
        glTextureSubImage3D((GLuint)texture, 0, 0, (GLint)t->top, layer, (GLsizei)in->view->width, (GLsizei)rows, 1, GL_RED,
                            GL_FLOAT, visibility + first);
    return gl_check(in->gl, err);
}
