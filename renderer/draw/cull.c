#include "draw/cull.h"

/* Signed distance (unscaled) of the box's most inward corner to the plane dot(n, p - origin) >= offset. */
static bool box_reaches(const struct dbox *box, struct dvec3 origin, struct dvec3 n, double offset)
{
    struct dvec3 corner =
        dvec3(n.x > 0 ? box->max.x : box->min.x, n.y > 0 ? box->max.y : box->min.y, n.z > 0 ? box->max.z : box->min.z);
    return dvec3_dot(n, dvec3_sub(corner, origin)) >= offset;
}

bool cull_box_visible(const struct view *v, const struct dbox *box, bool ignore_near)
{
    if (dbox_is_empty(box))
        return false;
    struct dvec3 f = v->forward;
    double slack = 1e-9 * (dbox_radius(box) + dvec3_length(dvec3_sub(dbox_center(box), v->eye)));
    bool in_depth = (ignore_near || box_reaches(box, v->eye, f, v->near - slack)) &&
                    (isinf(v->far) || box_reaches(box, v->eye, dvec3_neg(f), -v->far - slack));
    if (!in_depth)
        return false;
    if (v->orthographic)
        return box_reaches(box, v->eye, v->right, v->left - slack) &&
               box_reaches(box, v->eye, dvec3_neg(v->right), -v->right_edge - slack) &&
               box_reaches(box, v->eye, v->up, v->bottom - slack) && box_reaches(box, v->eye, dvec3_neg(v->up), -v->top - slack);
    return box_reaches(box, v->eye, dvec3_mad(v->right, f, -v->left), -slack) &&
           box_reaches(box, v->eye, dvec3_mad(dvec3_neg(v->right), f, v->right_edge), -slack) &&
           box_reaches(box, v->eye, dvec3_mad(v->up, f, -v->bottom), -slack) &&
           box_reaches(box, v->eye, dvec3_mad(dvec3_neg(v->up), f, v->top), -slack);
}
