#include "shadow/pixel_pass.h"

#include <epoxy/gl.h>

#include "gl/context.h"
#include "passes/gbuffer.h"

void pixel_put(float out[3], struct dvec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

struct pixel_rays pixel_rays_of(const struct view *view)
{
    struct dvec3 o, d, ox, dx, oy, dy;
    double w = 1.0 / view->width, h = 1.0 / view->height;
    view_ray(view, 0.5, 0.5, &o, &d);
    view_ray(view, 0.5 + view->width, 0.5, &ox, &dx);
    view_ray(view, 0.5, 0.5 + view->height, &oy, &dy);
    struct pixel_rays r;
    pixel_put(r.origin, dvec3_sub(o, view->eye));
    pixel_put(r.origin_dx, dvec3_scale(dvec3_sub(ox, o), w));
    pixel_put(r.origin_dy, dvec3_scale(dvec3_sub(oy, o), h));
    pixel_put(r.direction, d);
    pixel_put(r.direction_dx, dvec3_scale(dvec3_sub(dx, d), w));
    pixel_put(r.direction_dy, dvec3_scale(dvec3_sub(dy, d), h));
    return r;
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

/* The framework bound a framebuffer on the visibility layer; its texture is what the values go to. */
bool pixel_upload(const struct shadow_input *in, const float *visibility, struct error *err)
{
    GLint texture, layer;
    glGetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME,
                                          &texture);
    glGetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LAYER,
                                          &layer);
    const struct tiles *t = &in->gbuffer->tiles;
    if (t->top < t->bottom)
        glTextureSubImage3D((GLuint)texture, 0, 0, (GLint)t->top, layer, (GLsizei)in->view->width, (GLsizei)(t->bottom - t->top),
                            1, GL_RED, GL_FLOAT, visibility + (size_t)t->top * in->view->width);
    return gl_check(in->gl, err);
}
