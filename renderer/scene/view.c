#include "scene/view.h"

#include "scene/scene.h"

struct view view_from_camera(const struct camera *c, uint32_t width, uint32_t height)
{
    double top = c->orthographic ? c->ymag : tan(c->yfov / 2);
    double right_edge = top * ((double)width / height);
    return (struct view){
        .width = width,
        .height = height,
        .orthographic = c->orthographic,
        .eye = c->eye,
        .right = c->right,
        .up = c->up,
        .forward = dvec3_neg(c->back),
        .left = -right_edge,
        .right_edge = right_edge,
        .bottom = -top,
        .top = top,
        .near = c->near,
        .far = c->far,
    };
}

void view_limit_far(struct view *v, const struct dbox *bounds)
{
    if (!v->orthographic)
        return;
    double radius = dbox_radius(bounds);
    double end = dbox_is_empty(bounds) ? v->near : dvec3_dot(dvec3_sub(dbox_center(bounds), v->eye), v->forward) + 1.01 * radius;
    /* Never empty, not even where all lies before near. */
    double least = v->near + fmax(radius, 1e-6 * fmax(fabs(v->near), 1));
    v->far = fmin(v->far, fmax(end, least));
}

bool view_project(const struct view *v, struct dvec3 p, double *x, double *y, double *depth)
{
    struct dvec3 d = dvec3_sub(p, v->eye);
    double z = dvec3_dot(d, v->forward);
    if (!v->orthographic && !(z > 0))
        return false;
    double scale = v->orthographic ? 1 : 1 / z;
    *x = (dvec3_dot(d, v->right) * scale - v->left) / (v->right_edge - v->left) * v->width;
    *y = (dvec3_dot(d, v->up) * scale - v->top) / (v->bottom - v->top) * v->height;
    *depth = z;
    return true;
}
