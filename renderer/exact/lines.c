#include "exact/lines.h"

static double largest(struct dvec3 v) { return fmax(fmax(fabs(v.x), fabs(v.y)), fabs(v.z)); }

struct screen screen_make(const struct view *v)
{
    double x_step = (v->right_edge - v->left) / v->width, y_step = (v->bottom - v->top) / v->height;
    struct dvec3 corner = dvec3_mad(dvec3_scale(v->right, v->left), v->up, v->top);
    struct screen s = {
        .view = v,
        .fixed = v->orthographic ? v->forward : v->eye,
        .q = dvec3_add(v->orthographic ? v->eye : v->forward, corner),
        .qx = dvec3_scale(v->right, x_step),
        .qy = dvec3_scale(v->up, y_step),
    };
    s.size =
        largest(v->orthographic ? v->eye : v->forward) + fabs(v->left) + fabs(v->right_edge) + fabs(v->top) + fabs(v->bottom);
    s.size *= 2;
    return s;
}
