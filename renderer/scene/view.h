/* A viewpoint at a picture size: a camera's, or that of a light's map. Scene space, doubles.
 *
 * Pixel coordinates: x right, y down, (0, 0) the top left corner of the top left pixel; pixel centres at +0.5.
 * view_ray() is *the* definition of the ray through a picture position: its doubles are taken as exact by the reference
 * (reference/exact.h), and everybody else approximates them. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/dmath.h"

struct camera;

struct view {
    uint32_t width, height; /* pixels or texels */
    bool orthographic;
    struct dvec3 eye;
    struct dvec3 right, up, forward; /* unit, orthogonal */
    /* The picture's edges on the plane one unit in front of the eye (perspective: tangents) or in scene units
     * (orthographic); left < right_edge, bottom < top. */
    double left, right_edge, bottom, top;
    double near,
        far; /* along forward; 0 < near < far (perspective), near < far (orthographic, may be negative); far may be INFINITY
                         in perspective only */
};

/* Camera `c` filling width x height: the vertical extent is the camera's, the horizontal follows the picture's shape. */
struct view view_from_camera(const struct camera *c, uint32_t width, uint32_t height);

/* Parallel rays store their depth evenly between near and far, so a far end that lies far behind everything, or nowhere (INFINITY), would
 * leave no precision: pulls it to just behind `bounds`, which may be empty. Perspective views stay as they are. */
void view_limit_far(struct view *v, const struct dbox *bounds);

/* The ray through picture position (x, y): a point is origin + t * direction, and t is its depth along view.forward
 * (direction is not unit length; its component along forward is 1). Perspective: origin = eye. */
static inline void view_ray(const struct view *v, double x, double y, struct dvec3 *origin, struct dvec3 *direction)
{
    double sx = v->left + (v->right_edge - v->left) * (x / v->width);
    double sy = v->top + (v->bottom - v->top) * (y / v->height);
    struct dvec3 offset = dvec3_mad(dvec3_scale(v->right, sx), v->up, sy);
    if (v->orthographic) {
        *origin = dvec3_add(v->eye, offset);
        *direction = v->forward;
    } else {
        *origin = v->eye;
        *direction = dvec3_add(v->forward, offset);
    }
}

/* Picture position and depth of scene-space point `p`; false (and untouched results) when p is behind a perspective eye. */
bool view_project(const struct view *v, struct dvec3 p, double *x, double *y, double *depth);

/* The 32 sub-pixel sample positions of *samples32*, in pixels from the pixel's top left corner: multiples of 1/64, so exact in every format.
 * One sample in each of 32 columns and 32 rows (a Latin pattern with good spread); bit i of a mask is sample i. */
extern const float view_samples32[32][2];
