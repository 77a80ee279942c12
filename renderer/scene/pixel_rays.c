#include "scene/pixel_rays.h"

static void put(float out[3], struct dvec3 v)
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
    put(r.origin, dvec3_sub(o, view->eye));
    put(r.origin_dx, dvec3_scale(dvec3_sub(ox, o), w));
    put(r.origin_dy, dvec3_scale(dvec3_sub(oy, o), h));
    put(r.direction, d);
    put(r.direction_dx, dvec3_scale(dvec3_sub(dx, d), w));
    put(r.direction_dy, dvec3_scale(dvec3_sub(dy, d), h));
    return r;
}
