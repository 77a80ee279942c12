/* A tile's code: triangles as receivers and as occluders, and where a pixel's part of a receiver lies in the light's grid. */
#pragma once

#include <stdatomic.h>

#include "exact/hole_samples.h"
#include "exact/simd.h"
#include "exact/tile.h"
#include "reference/filter.h"

static inline struct exact_apex eye_of(const struct view *view)
{
    return (struct exact_apex){view->orthographic, view->orthographic ? view->forward : view->eye};
}

/* slow_light_side(), from forms seen from the light where they decide. */
static inline int light_side(struct tile_scratch *s, const struct tile_job *job, const struct forms *f, uint32_t id)
{
    const struct dvec3 *l = &job->to_light.v;
    bool infinite = job->to_light.infinite;
    double x = infinite ? l->x : l->x - f->ax[3], y = infinite ? l->y : l->y - f->ay[3], z = infinite ? l->z : l->z - f->az[3];
    double value = f->x[3] * x + f->y[3] * y + f->z[3] * z;
    double error = LINE_ROUNDING * f->size[3] * (fabs(x) + fabs(y) + fabs(z)) + LINE_UNDERFLOW;
    return fabs(value) > error ? (value > 0 ? 1 : -1) : slow_light_side(&s->slow, id);
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
    o->side = light_side(s, job, &forms, id);
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

static inline void masked_make(struct masked *m, const struct tile_job *job, uint32_t id)
{
    struct dvec3 c[3];
    triangle_corners(job->triangles, id, c);
    m->id = id;
    m->a = c[0];
    m->e1 = fabs(c[1].x - c[0].x) + fabs(c[1].y - c[0].y) + fabs(c[1].z - c[0].z);
    m->e2 = fabs(c[2].x - c[0].x) + fabs(c[2].y - c[0].y) + fabs(c[2].z - c[0].z);
    hole_map_make(&m->map, &job->triangles->masks, job->triangles->scene, id);
}

/* `o`: an occluder with a mask. */
static inline const struct masked *masked_get(struct tile_scratch *s, const struct tile_job *job, const struct occluder *o)
{
    struct masked *m = &s->masked[o->id % MASKED_KEPT];
    if (m->id == o->id)
        return m;
    struct dvec3 c[3];
    struct forms forms;
    struct lines lines;
    triangle_corners(job->triangles, o->id, c);
    forms_make(&forms, &job->to_light, &c[0], &c[1], &c[2]);
    lines_make(&lines, &forms, &job->screen);
    masked_make(m, job, o->id);
    m->unscale = lines.fixed_size + lines.v_size + LINE_UNDERFLOW;
    return m;
}

/* What is known of it already. */
static inline void receiver_recall(struct receiver *r, const struct light_grid *grid)
{
    unsigned known = atomic_load_explicit(&grid->known[r->id], memory_order_acquire), count = 0;
    r->side = (int)(known >> LIGHT_KNOWN_BITS) - 2;
    known &= (1 << LIGHT_KNOWN_BITS) - 1;
    uint32_t *to = known == LIGHT_FEW ? r->candidates : r->recent.ids;
    r->recent.count = 0;
    r->candidate_area = known == LIGHT_UNKNOWN ? AREA_NONE : AREA_PICTURE;
    r->candidate_count = known == LIGHT_MANY ? CANDIDATES_MANY : 0;
    if (known <= LIGHT_NOTHING)
        return;
    for (; count < LIGHT_OTHERS; count++) {
        to[count] = atomic_load_explicit(&grid->others[r->id][count], memory_order_relaxed);
        if (to[count] == SCENE_NONE)
            break;
    }
    *(known == LIGHT_FEW ? (unsigned *)&r->candidate_count : &r->recent.count) = count;
}

/* All that say LIGHT_FEW of a triangle name the same others, and none says LIGHT_MANY: so a reader never mixes the two. */
static inline void light_learn(const struct light_grid *grid, const struct receiver *r, enum light_known known,
                               const uint32_t *others, unsigned count)
{
    for (unsigned i = 0; known > LIGHT_NOTHING && i <= count && i < LIGHT_OTHERS; i++)
        atomic_store_explicit(&grid->others[r->id][i], i < count ? others[i] : SCENE_NONE, memory_order_relaxed);
    atomic_store_explicit(&grid->known[r->id], (uint8_t)(known | (unsigned)(r->side + 2) << LIGHT_KNOWN_BITS),
                          memory_order_release);
}

/* Its edges and plane seen from the light, which only those need that may be shadowed; and the light's side. */
static inline void receiver_see_light(struct receiver *r, struct tile_scratch *s, const struct tile_job *job)
{
    struct dvec3 c[3];
    triangle_corners(job->triangles, r->id, c);
    forms_make(&r->to_light, &job->to_light, &c[0], &c[1], &c[2]);
    if (r->side < -1) {
        r->side = light_side(s, job, &r->to_light, r->id);
        atomic_fetch_or_explicit(&job->grid->known[r->id], (uint8_t)((r->side + 2) << LIGHT_KNOWN_BITS), memory_order_relaxed);
    }
    r->to_light.x *= r->side;
    r->to_light.y *= r->side;
    r->to_light.z *= r->side;
    r->sees_light = true;
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
    r->edge = lines.v, r->edge_x = lines.vx, r->edge_y = lines.vy;
    r->edge_error = lines.v_size * LINE_ROUNDING + LINE_UNDERFLOW;
    r->certain = fabs(r->fixed) > LINE_ROUNDING * r->fixed_size + LINE_UNDERFLOW;
    /* N . d where the camera sees it: against F in perspective, F itself else. */
    int slope = (lines.fixed[3] > 0) == job->view->orthographic ? 1 : -1;
    r->crowded_tile = AREA_NONE;
    r->boxed = r->sees_light = false;
    receiver_recall(r, job->grid);
    if (r->side < -1)
        receiver_see_light(r, s, job);
    r->faces = slope * r->side < 0;
}

/* Its boxes on the light's faces, which only those need that may be shadowed. */
static inline void receiver_boxes(struct receiver *r, struct tile_scratch *s, const struct tile_job *job)
{
    struct dvec3 c[3];
    if (r->boxed)
        return;
    if (!r->sees_light)
        receiver_see_light(r, s, job);
    r->boxed = true;
    r->faces_met = 0;
    triangle_corners(job->triangles, r->id, c);
    for (unsigned f = 0; f < job->grid->face_count; f++)
        r->faces_met |= (unsigned)(light_face_box(job->grid, &job->grid->faces[f], c, 3, 0, &r->boxes[f]) == FACE_SOME) << f;
}

/* True when `id` certainly shadows nothing of the receiver, which faces the light: all its corners lie beyond one of the planes through
 * the light and an edge of the receiver, or below the receiver's own plane. A corner that they share lies on that plane, exactly, and
 * the rest beyond: then the open line from a point of the receiver to the light does not meet the closed triangle, whatever the tie
 * rule. That settles a dense mesh's neighbours. `anywhere`: the points may lie outside the receiver's edges, on its plane. */
static inline bool cannot_shadow(const struct receiver *r, const struct tile_job *job, uint32_t id, bool anywhere)
{
    /* Edges ab, bc, ca and the plane that each set of corners lies on. */
    static const uint8_t on[8] = {0, 1 | 4 | 8, 1 | 2 | 8, 0, 2 | 4 | 8, 0, 0, 0};
    const struct forms *f = &r->to_light;
    const lane4 zero = {0, 0, 0, 0};
    unsigned beyond = anywhere ? 8 : 15;
    for (int k = 0; k < 3 && beyond; k++) {
        const struct dvec3 *v = &job->triangles->vertices[job->triangles->corners[id][k]];
        lane4 x = v->x - f->ax, y = v->y - f->ay, z = v->z - f->az;
        lane4 reach = lane_abs(x) + lane_abs(y) + lane_abs(z), value = f->x * x + f->y * y + f->z * z;
        lane4 under = -LINE_ROUNDING * f->size * reach - LINE_UNDERFLOW;
        unsigned apart = lanes_above(&reach, &zero) & 7;
        beyond &= lanes_above(&under, &value) | on[~apart & 7];
    }
    return beyond != 0;
}

/* True when the receiver's triangle certainly lies on the light's side of `id`, corners that they share on its plane. */
static inline bool is_on_lit_side(const struct receiver *r, const struct tile_job *job, uint32_t id)
{
    const struct forms *f = &r->to_light;
    struct dvec3 c[3];
    triangle_corners(job->triangles, id, c);
    struct dvec3 u = dvec3_sub(c[1], c[0]), v = dvec3_sub(c[2], c[0]);
    struct form plane = form_make(u, v, c[0]);
    double error, light = job->to_light.infinite ? form_slope(&plane, job->to_light.v, &error)
                                                 : form_value(&plane, job->to_light.v, 0, &error);
    if (!(fabs(light) > error))
        return false;
    for (int k = 0; k < 3; k++) {
        struct dvec3 p = dvec3(f->ax[k], f->ay[k], f->az[k]);
        double value = form_value(&plane, p, 0, &error) * (light > 0 ? 1 : -1);
        bool shared = false;
        for (int i = 0; i < 3; i++)
            shared |= c[i].x == p.x && c[i].y == p.y && c[i].z == p.z;
        if (!shared && !(value > error))
            return false;
    }
    return true;
}

static inline struct receiver *receiver_get(struct tile_scratch *s, const struct tile_job *job, uint32_t id)
{
    struct receiver *r = &s->seen[id % RECEIVERS_KEPT];
    if (r->id != id)
        receiver_make(r, s, job, id);
    return r;
}

/* 1 or -1 when the ray at (x, y) certainly crosses the inside of the receiver, one way or the other, before the eye, and the receiver is
 * certain; else 0. */
static inline int inside_of(const struct tile_job *job, const struct receiver *r, double x, double y)
{
    lane4 value = r->edge + x * r->edge_x + y * r->edge_y, under = -value;
    double v = r->v + x * r->vx + y * r->vy;
    if (!r->certain || (!job->view->orthographic && !(v > LINE_ROUNDING * r->v_size + LINE_UNDERFLOW)))
        return 0;
    return (lanes_above(&value, &r->edge_error) & 7) == 7 ? 1 : (lanes_above(&under, &r->edge_error) & 7) == 7 ? -1 : 0;
}

/* Points of a receiver's plane at four picture positions, and how far off they may be. */
struct quad {
    lane4 x, y, z;
    double slack;
};

static inline __attribute__((always_inline)) double lane_least(lane4 a)
{
    double x = a[0] < a[1] ? a[0] : a[1], y = a[2] < a[3] ? a[2] : a[3];
    return x < y ? x : y;
}

static inline __attribute__((always_inline)) double lane_most(lane4 a)
{
    double x = a[0] > a[1] ? a[0] : a[1], y = a[2] > a[3] ? a[2] : a[3];
    return x > y ? x : y;
}

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
    q->x = ax, q->y = ay, q->z = az;
    q->slack = 2 * lane_most(off) * (flat ? 1 : s->size) +
               LINE_ROUNDING * (fabs(s->fixed.x) + fabs(s->fixed.y) + fabs(s->fixed.z) + s->size);
    return true;
}

static inline bool light_reaches_all(const struct light *light)
{
    return light->kind == LIGHT_DIRECTIONAL || (light->kind == LIGHT_POINT && !(light->range > 0));
}

/* Whether all, none or some of the convex hull of `q` lies within the light's cone and range: 1, 0, -1. The functions compared have slopes of
 * at most 2. */
static inline int quad_within_reach(const struct light *light, const struct quad *q)
{
    if (light_reaches_all(light))
        return 1;
    struct dvec3 middle = dvec3(0.5 * (q->x[0] + q->x[3]), 0.5 * (q->y[0] + q->y[3]), 0.5 * (q->z[0] + q->z[3]));
    struct dvec3 v = dvec3_sub(middle, light->position);
    lane4 dx = q->x - middle.x, dy = q->y - middle.y, dz = q->z - middle.z;
    double distance = dvec3_length(v), radius = sqrt(lane_most(dx * dx + dy * dy + dz * dz));
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

/* light_face_box() of a quad on a face without limits, all of it before the light; false: not so, ask light_face_box(). */
static inline bool quad_box(const struct light_grid *grid, const struct light_face *face, const struct quad *q,
                            struct light_box *box)
{
    const struct dvec3 none = {0, 0, 0}, *from = grid->directional ? &none : &grid->position;
    const struct dvec3 *r = &face->right, *up = &face->up, *f = &face->forward;
    lane4 x = q->x - from->x, y = q->y - from->y, z = q->z - from->z;
    lane4 u = x * r->x + y * r->y + z * r->z, v = x * up->x + y * up->y + z * up->z, depth = x * f->x + y * f->y + z * f->z;
    double error = 2 * q->slack + 0x1p-47 * lane_most(lane_abs(x) + lane_abs(y) + lane_abs(z));
    double nearest = lane_least(depth), du = error, dv = error;
    if (!grid->directional) {
        if (!(nearest > 4 * error) || face->limit < INFINITY)
            return false;
        u /= depth, v /= depth;
        double k = 2 * error / nearest;
        du = k * (1 + lane_most(lane_abs(u)));
        dv = k * (1 + lane_most(lane_abs(v)));
    }
    *box = (struct light_box){box_below(lane_least(u) - du), box_above(lane_most(u) + du), box_below(lane_least(v) - dv),
                              box_above(lane_most(v) + dv),  box_below(nearest - error),   box_above(lane_most(depth) + error)};
    return true;
}

static inline enum face_part quad_face_box(const struct light_grid *grid, const struct light_face *face, const struct quad *q,
                                           struct light_box *box)
{
    if (quad_box(grid, face, q, box))
        return FACE_SOME;
    struct dvec3 points[4];
    for (int i = 0; i < 4; i++)
        points[i] = dvec3(q->x[i], q->y[i], q->z[i]);
    return light_face_box(grid, face, points, 4, q->slack, box);
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
    if (quad_face_box(job->grid, &job->grid->faces[f], q, box) == FACE_NONE)
        return false;
    if (!own)
        return true;
    box->u0 = box_max(box->u0, own->u0), box->u1 = box_min(box->u1, own->u1);
    box->v0 = box_max(box->v0, own->v0), box->v1 = box_min(box->v1, own->v1);
    box->near = box_max(box->near, own->near), box->far = box_min(box->far, own->far);
    return box->u0 <= box->u1 && box->v0 <= box->v1;
}
