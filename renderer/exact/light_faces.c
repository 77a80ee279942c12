/* What a light's faces see. */
#include "exact/light_faces.h"

#include <string.h>

/* One face sees this far to the sides: 84 degrees. Level 0 of its grid is spread over where the triangles are. */
#define CONE_COSINE  0.1
#define CONE_TANGENT 9.9
#define ROUNDING     0x1p-47 /* 64 roundings of a dot product's terms */
#define FACE_MARGIN  (1 + 1e-6)

struct on_face {
    double u, v, z;
    double error; /* of q . axis */
};

static struct on_face look(const struct light_grid *grid, const struct light_face *face, struct dvec3 point, double slack)
{
    struct dvec3 q = grid->directional ? point : dvec3_sub(point, grid->position);
    return (struct on_face){
        .u = dvec3_dot(q, face->right),
        .v = dvec3_dot(q, face->up),
        .z = dvec3_dot(q, face->forward),
        .error = 2 * slack + ROUNDING * (fabs(q.x) + fabs(q.y) + fabs(q.z)),
    };
}

static inline void box_add(struct light_box *box, double u0, double u1, double v0, double v1)
{
    box->u0 = box_min(box->u0, box_below(u0));
    box->u1 = box_max(box->u1, box_above(u1));
    box->v0 = box_min(box->v0, box_below(v0));
    box->v1 = box_max(box->v1, box_above(v1));
}

enum face_part light_face_box(const struct light_grid *grid, const struct light_face *face, const struct dvec3 *points, int count,
                              double slack, struct light_box *box)
{
    bool out[5] = {true, true, true, true, true};
    *box = (struct light_box){INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY};
    for (int i = 0; i < count; i++) {
        struct on_face p = look(grid, face, points[i], slack);
        box->near = box_min(box->near, box_below(p.z - p.error));
        box->far = box_max(box->far, box_above(p.z + p.error));
        if (grid->directional) {
            box_add(box, p.u - p.error, p.u + p.error, p.v - p.error, p.v + p.error);
            continue;
        }
        if (face->limit < INFINITY) {
            double most = face->limit * p.z, error = (1 + face->limit) * p.error;
            out[0] &= p.u - most > error;
            out[1] &= -p.u - most > error;
            out[2] &= p.v - most > error;
            out[3] &= -p.v - most > error;
        }
        out[4] &= p.z < -p.error;
        if (p.z > 4 * p.error) {
            double u = p.u / p.z, v = p.v / p.z;
            double du = 2 * p.error * (1 + fabs(u)) / p.z, dv = 2 * p.error * (1 + fabs(v)) / p.z;
            box_add(box, u - du, u + du, v - dv, v + dv);
        } else {
            box_add(box, -INFINITY, INFINITY, -INFINITY, INFINITY);
        }
    }
    if (grid->directional)
        return FACE_SOME;
    bool within = face->limit < INFINITY;
    return out[4] || (within && (out[0] || out[1] || out[2] || out[3])) ? FACE_NONE : FACE_SOME;
}

static struct light_face face_along(struct dvec3 forward, double limit)
{
    struct dvec3 other = fabs(forward.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
    struct light_face face = {.forward = forward, .limit = limit};
    face.right = dvec3_normalize(dvec3_cross(forward, other));
    face.up = dvec3_cross(face.right, forward);
    return face;
}

/* Unit directions from the light to the corners of all there is. */
static void to_corners(const struct dbox *box, struct dvec3 position, struct dvec3 out[8])
{
    for (int i = 0; i < 8; i++) {
        struct dvec3 corner =
            dvec3(i & 1 ? box->max.x : box->min.x, i & 2 ? box->max.y : box->min.y, i & 4 ? box->max.z : box->min.z);
        out[i] = dvec3_normalize(dvec3_sub(corner, position));
    }
}

/* An axis about which a narrow cone holds all: a few steps towards the corner that is farthest off, each shorter than the last (Badoiu and
 * Clarkson, "Smaller core-sets for balls", 2003, on the sphere). False when no cone of CONE_COSINE was found. A cone of less than 180
 * degrees that holds the corners of a box holds the box. */
static bool find_axis(const struct dbox *box, struct dvec3 position, struct dvec3 *axis)
{
    struct dvec3 corners[8], sum = {0, 0, 0};
    if (dbox_is_empty(box))
        return false;
    to_corners(box, position, corners);
    for (int i = 0; i < 8; i++)
        sum = dvec3_add(sum, corners[i]);
    *axis = dvec3_normalize(sum);
    for (int step = 2; step < 32; step++) {
        int farthest = 0;
        for (int i = 1; i < 8; i++)
            if (dvec3_dot(corners[i], *axis) < dvec3_dot(corners[farthest], *axis))
                farthest = i;
        if (dvec3_dot(corners[farthest], *axis) > CONE_COSINE)
            return true;
        *axis = dvec3_normalize(dvec3_mad(*axis, corners[farthest], 1.0 / step));
    }
    return false;
}

void light_faces_choose(struct light_grid *grid, const struct triangles *t, const struct light *light)
{
    grid->face_count = 1;
    grid->directional = light->kind == LIGHT_DIRECTIONAL;
    grid->position = light->position;
    if (grid->directional) {
        grid->faces[0] = face_along(light->direction, INFINITY);
        return;
    }
    if (light->kind == LIGHT_SPOT && tan(light->outer) <= CONE_TANGENT && light->outer < 1.5) {
        grid->faces[0] = face_along(light->direction, tan(light->outer) * FACE_MARGIN + 1e-9);
        return;
    }
    struct dvec3 axis;
    if (find_axis(&t->bounds, light->position, &axis)) {
        grid->faces[0] = face_along(axis, INFINITY);
        return;
    }
    grid->face_count = 6;
    for (int i = 0; i < 6; i++) {
        double s = i % 2 ? -1 : 1;
        grid->faces[i] = face_along(dvec3(i / 2 == 0 ? s : 0, i / 2 == 1 ? s : 0, i / 2 == 2 ? s : 0), FACE_MARGIN);
    }
}
