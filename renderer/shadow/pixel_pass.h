/* What systems share that decide pixels on the CPU, from what the camera pass left (scene/pixel.h): the pixels' rays and the light as
 * shaders/receiver.glsl has them, in the same single precision, and the way of the values to the visibility buffer. */
#pragma once

#include "scene/pixel_rays.h"
#include "shadow/shadow.h"

struct pixel_light {
    enum light_kind kind;
    float light[3]; /* position relative to the camera's eye; or the direction against the light's */
    float axis[3], cosine, range2;
};

struct pixel_light pixel_light_of(const struct light *light, struct dvec3 camera_eye);
void pixel_put(float out[3], struct dvec3 v);

/* Room for one value a pixel of in->view: the layer's own where it has room, else scratch until the next call. */
float *pixel_values(const struct shadow_input *in, struct error *err);

/* `visibility`: one value a pixel of in->view, pixel_values() or other memory, to the layer; only rows that hold surfaces are looked at. */
bool pixel_upload(const struct shadow_input *in, const float *visibility, struct error *err);
