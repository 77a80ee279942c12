/* The rays through a picture's pixels in single precision, relative to the camera's eye: both parts are affine in the pixel's position. */
#pragma once

#include "scene/view.h"

/* The ray through the centre of pixel (x, y): origin + x origin_dx + y origin_dy + depth (direction + x direction_dx + y direction_dy). */
struct pixel_rays {
    float origin[3], origin_dx[3], origin_dy[3], direction[3], direction_dx[3], direction_dy[3];
};

struct pixel_rays pixel_rays_of(const struct view *view);
