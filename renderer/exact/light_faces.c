/* What a light's faces see. */
#include "exact/light_faces.h"

#include <string.h>

#define CONE_COSINE  0.5 /* half of 120 degrees */
#define CONE_TANGENT 1.7320508075688772
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

static void box_add(struct light_box *box, double u0, double u1, double v0, double v1)
{
    box->u0 = fminf(box->u0, box_below(u0));
    box->u1 = fmaxf(box->u1, box_above(u1));
    box->v0 = fminf(box->v0, box_below(v0));
    box->v1 = fmaxf(box->v1, box_above(v1));
}

enum face_part light_face_box(const struct light_grid *grid, const struct light_face *face, const struct dvec3 *points, int count,
                              double slack, struct light_box *box)
{
    bool out[5] = {true, true, true, true, true};
    *box = (struct light_box){INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY};
    for (int i = 0; i < count; i++) {
        struct on_face p = look(grid, face, points[i], slack);
        box->near = fminf(box->near, box_below(p.z - p.error));
        box->far = fmaxf(box->far, box_above(p.z + p.error));
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

static bool fit_in_cone(const struct triangles *t, struct dvec3 position, struct dvec3 axis)
{
    for (uint32_t i = 0; i < t->count; i++) {
        if (t->flags[i] & TRIANGLE_IGNORED)
            continue;
        for (int k = 0; k < 3; k++) {
            struct dvec3 q = dvec3_sub(t->vertices[t->corners[i][k]], position);
            if (!(dvec3_dot(q, axis) > CONE_COSINE * dvec3_length(q)))
                return false;
        }
    }
    return true;
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
    if (!dbox_is_empty(&t->bounds)) {
        struct dvec3 axis = dvec3_normalize(dvec3_sub(dbox_center(&t->bounds), light->position));
        if (dvec3_length(axis) > 0.9 && fit_in_cone(t, light->position, axis)) {
            grid->faces[0] = face_along(axis, INFINITY);
            return;
        }
    }
    grid->face_count = 6;
    for (int i = 0; i < 6; i++) {
        double s = i % 2 ? -1 : 1;
        grid->faces[i] = face_along(dvec3(i / 2 == 0 ? s : 0, i / 2 == 1 ? s : 0, i / 2 == 2 ? s : 0), FACE_MARGIN);
    }
}
