/* A tile's code: triangles as receivers and as occluders, and where a pixel's part of a receiver lies in the light's grid. */
#pragma once

#include "exact/simd.h"
#include "exact/tile.h"

static inline struct exact_apex eye_of(const struct view *view)
{
    return (struct exact_apex){view->orthographic, view->orthographic ? view->forward : view->eye};
}

static inline const struct occluder *occluder_get(struct tile_scratch *s, const struct tile_job *job, uint32_t id)
{
    struct occluder *o = &s->occluders[id % OCCLUDERS_KEPT];
    if (o->id == id)
        return o;
    struct dvec3 c[3];
    struct forms forms;
    triangle_corners(job->triangles, id, c);
    forms_make(&forms, &job->to_light, &c[0], &c[1], &c[2]);
    lines_make(&o->lines, &forms, &job->screen);
    o->id = id;
    o->side = slow_light_side(&s->slow, id);
    double k = o->side;
    lane4 scale = (lane4){k, k, k, -k} / (o->lines.fixed_size + o->lines.v_size + LINE_UNDERFLOW), size = lane_abs(scale);
    o->lines.fixed *= scale;
    o->lines.v *= scale;
    o->lines.vx *= scale;
    o->lines.vy *= scale;
    o->lines.fixed_size *= size;
    o->lines.v_size *= size;
    return o;
}

static inline void receiver_make(struct receiver *r, struct tile_scratch *s, const struct tile_job *job, uint32_t id)
{
    struct dvec3 c[3];
    struct forms forms;
    struct lines lines;
    struct exact_apex eye = eye_of(job->view);
    triangle_corners(job->triangles, id, c);
    forms_make(&forms, &eye, &c[0], &c[1], &c[2]);
    lines_make(&lines, &forms, &job->screen);
    double scale = (lines.fixed[3] > 0 ? -1 : 1) / (lines.fixed_size[3] + lines.v_size[3] + LINE_UNDERFLOW);
    r->id = id;
    r->fixed = lines.fixed[3] * scale;
    r->v = lines.v[3] * scale;
    r->vx = lines.vx[3] * scale;
    r->vy = lines.vy[3] * scale;
    r->fixed_size = lines.fixed_size[3] * fabs(scale);
    r->v_size = lines.v_size[3] * fabs(scale);
    r->certain = fabs(r->fixed) > LINE_ROUNDING * r->fixed_size + LINE_UNDERFLOW;
    /* N . d where the camera sees it: against F in perspective, F itself else. */
    int slope = (lines.fixed[3] > 0) == job->view->orthographic ? 1 : -1;
    r->faces = slope * slow_light_side(&s->slow, id) < 0;
    r->faces_met = 0;
    for (unsigned f = 0; f < job->grid->face_count; f++)
        r->faces_met |= (unsigned)(light_face_box(job->grid, &job->grid->faces[f], c, 3, 0, &r->boxes[f]) == FACE_SOME) << f;
}

static inline const struct receiver *receiver_get(struct tile_scratch *s, const struct tile_job *job, uint32_t id)
{
    struct receiver *r = &s->seen[id % RECEIVERS_KEPT];
    if (r->id != id)
        receiver_make(r, s, job, id);
    return r;
}

/* Points of a receiver's plane at four picture positions, and how far off they may be. */
struct quad {
    struct dvec3 points[4];
    double slack;
};

/* False where the plane's horizon is near: the points would mean nothing. */
static inline bool quad_make(struct quad *q, const struct tile_job *job, const struct receiver *r, double x, double y,
                             double width)
{
    const lane4 px = {x, x + width, x, x + width}, py = {y, y, y + width, y + width};
    const struct screen *s = &job->screen;
    lane4 v = r->v + px * r->vx + py * r->vy, t;
    lane4 size = lane_abs(v), least = lane_all(r->v_size * 0x1p-24), zero = lane_all(0);
    bool flat = job->view->orthographic;
    if (!(fabs(r->fixed) > r->fixed_size * 0x1p-24) || (!flat && lanes_above(&v, &zero) != 15) ||
        (!flat && lanes_above(&size, &least) != 15))
        return false;
    t = flat ? -v / r->fixed : -r->fixed / v;
    lane4 qx = s->q.x + px * s->qx.x + py * s->qy.x, qy = s->q.y + px * s->qx.y + py * s->qy.y,
          qz = s->q.z + px * s->qx.z + py * s->qy.z;
    lane4 ax = flat ? qx : lane_all(s->fixed.x), ay = flat ? qy : lane_all(s->fixed.y), az = flat ? qz : lane_all(s->fixed.z);
    lane4 dx = flat ? lane_all(s->fixed.x) : qx, dy = flat ? lane_all(s->fixed.y) : qy, dz = flat ? lane_all(s->fixed.z) : qz;
    ax += t * dx, ay += t * dy, az += t * dz;
    /* t is off by V's and F's relative errors (perspective) or by V's error over F; o and d by a rounding or two. */
    lane4 off = flat ? lane_all(LINE_ROUNDING * (r->v_size + fabs(r->fixed_size)) / fabs(r->fixed)) * (1 + lane_abs(t))
                     : t * (LINE_ROUNDING * (r->v_size / v + r->fixed_size / fabs(r->fixed)) + LINE_ROUNDING);
    double most = 0;
    for (int i = 0; i < 4; i++) {
        q->points[i] = dvec3(ax[i], ay[i], az[i]);
        most = fmax(most, off[i]);
    }
    q->slack =
        2 * most * (flat ? 1 : s->size) + LINE_ROUNDING * (fabs(s->fixed.x) + fabs(s->fixed.y) + fabs(s->fixed.z) + s->size);
    return true;
}

/* Whether all, none or some of the convex hull of `q` lies within the light's cone and range: 1, 0, -1. The functions compared have slopes of
 * at most 2. */
static inline int quad_within_reach(const struct light *light, const struct quad *q)
{
    if (light->kind == LIGHT_DIRECTIONAL || (light->kind == LIGHT_POINT && !(light->range > 0)))
        return 1;
    struct dvec3 middle = dvec3_scale(dvec3_add(q->points[0], q->points[3]), 0.5), v = dvec3_sub(middle, light->position);
    double distance = dvec3_length(v), radius = 0;
    for (int i = 0; i < 4; i++)
        radius = fmax(radius, dvec3_length(dvec3_sub(q->points[i], middle)));
    radius = 2 * radius + 4 * q->slack + 0x1p-40 * (distance + dvec3_length(middle) + dvec3_length(light->position));
    int answer = 1;
    if (light->range > 0) {
        if (distance - light->range > radius)
            return 0;
        answer = light->range - distance > radius ? answer : -1;
    }
    if (light->kind == LIGHT_SPOT) {
        double inside = dvec3_dot(v, light->direction) - cos(light->outer) * distance;
        if (inside < -radius)
            return 0;
        answer = inside > radius ? answer : -1;
    }
    return answer;
}

/* What of a face a pixel's part of a receiver may meet; false: nothing. quad: NULL: not known. own: the receiver's box there; NULL: the
 * points need not lie on the triangle. */
static inline bool query_box(const struct tile_job *job, const struct light_box *own, unsigned f, const struct quad *q,
                             struct light_box *box)
{
    if (!q) {
        *box = own ? *own : (struct light_box){-INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY};
        return true;
    }
    if (light_face_box(job->grid, &job->grid->faces[f], q->points, 4, q->slack, box) == FACE_NONE)
        return false;
    if (!own)
        return true;
    box->u0 = fmaxf(box->u0, own->u0), box->u1 = fminf(box->u1, own->u1);
    box->v0 = fmaxf(box->v0, own->v0), box->v1 = fminf(box->v1, own->v1);
    box->near = fmaxf(box->near, own->near), box->far = fminf(box->far, own->far);
    return box->u0 <= box->u1 && box->v0 <= box->v1;
}
