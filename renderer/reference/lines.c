#include "reference/lines.h"

#include <assert.h>

#include "reference/rules.h"

/* A candidate, as the callbacks see it. */
struct candidate {
    const struct candidate_part *part;
    uint32_t index, id;
    struct dvec3 corners[3];
    struct form plane;
};

/* Embree's packet layouts: member k of lane i at [16 k + i] (rtcore_ray.h). */
enum { RAY_TFAR = 8 * LANES };

static unsigned lane_bits(const int *valid)
{
    unsigned bits = 0;
    for (unsigned i = 0; i < LANES; i++)
        bits |= (unsigned)(valid[i] != 0) << i;
    return bits;
}

/* The line's own point, exactly. */
static struct exact_point line_point(const struct line_packet *p, unsigned lane, bool shadow)
{
    const struct receiver *at = &p->receiver[lane];
    if (!shadow)
        return p->directions ? (struct exact_point){.kind = EXACT_DIRECTION, .v = at->direction}
                             : (struct exact_point){.kind = EXACT_POINT, .v = at->origin};
    struct exact_point point = {.kind = EXACT_ON_PLANE, .ray_origin = at->origin, .ray_direction = at->direction};
    const struct candidate_part *part = candidate_part_of(p->reference, at->id);
    candidate_corners(part, at->id - part->first_triangle, point.plane);
    return point;
}

/* Lanes whose line may cross the triangle's inside; *sure: those that certainly do. */
static unsigned may_cross(const struct line_packet *p, const struct dvec3 c[3], unsigned lanes, unsigned *sure)
{
    unsigned left = lanes, right = lanes; /* lanes that may pass every edge on that side */
    unsigned sure_left = lanes, sure_right = lanes;
    for (int i = 0; i < 3; i++) {
        struct form edge = form_edge(&p->apex, p->directions, c[i], c[(i + 1) % 3]);
        unsigned positive, negative;
        filter_signs(&edge, &p->lanes, &positive, &negative);
        left &= ~negative;
        right &= ~positive;
        sure_left &= positive;
        sure_right &= negative;
        if (!(left | right))
            return 0;
    }
    *sure = sure_left | sure_right;
    return left | right;
}

static bool crosses_exactly(struct line_packet *p, const struct exact_point *point, const struct dvec3 c[3])
{
    p->exact++;
    int first = exact_edge_side(&p->apex, point, c[0], c[1]);
    return first != 0 && exact_edge_side(&p->apex, point, c[1], c[2]) == first &&
           exact_edge_side(&p->apex, point, c[2], c[0]) == first;
}

int lines_apex_side(struct line_packet *p, const struct exact_apex *apex, const struct dvec3 corners[3], const struct form *plane)
{
    double error, value = apex->infinite ? form_slope(plane, apex->v, &error) : form_value(plane, apex->v, 0, &error);
    if (fabs(value) > error)
        return value > 0 ? 1 : -1;
    p->exact++;
    return exact_apex_side(apex, corners);
}

static bool is_solid(const struct candidate *c, struct dvec3 origin, struct dvec3 direction)
{
    return !c->part->holes ||
           rule_is_solid(c->part->reference->scene, c->part->instance, c->index, c->corners, origin, direction);
}

/* Certain comparison of t with a limit: -1, 0, 1. */
static int compare_depth(struct line_packet *p, const struct candidate *c, const struct receiver *ray, double t, double error,
                         double limit)
{
    if (isinf(limit) || fabs(t - limit) > error + 0x1p-50 * fabs(limit))
        return t > limit ? 1 : -1;
    p->exact++;
    return exact_compare_depth(ray->origin, ray->direction, c->corners, limit);
}

/* True when the candidate lies before what `lane` has found so far. */
static bool is_nearer(struct line_packet *p, const struct candidate *c, unsigned lane, double t, double error)
{
    const struct receiver *at = &p->receiver[lane];
    if (at->id == SCENE_NONE)
        return true;
    if (fabs(t - p->depth[lane]) > error + p->depth_error[lane])
        return t < p->depth[lane];
    struct dvec3 other[3];
    const struct candidate_part *part = candidate_part_of(p->reference, at->id);
    candidate_corners(part, at->id - part->first_triangle, other);
    p->exact++;
    int order = exact_compare_depths(at->origin, at->direction, c->corners, other);
    return order < 0 || (order == 0 && c->id < at->id);
}

/* True when `lane` now has the candidate. */
static bool take_if_visible(struct line_packet *p, const struct candidate *c, unsigned lane, bool sure)
{
    struct receiver *at = &p->receiver[lane];
    double error, t = form_depth(&c->plane, at->origin, at->direction, &error);
    if (at->id != SCENE_NONE && t - p->depth[lane] > error + p->depth_error[lane])
        return false;
    if (!sure) {
        struct exact_point point = line_point(p, lane, false);
        if (!crosses_exactly(p, &point, c->corners))
            return false;
    }
    int slope = lines_apex_side(p, &(struct exact_apex){true, at->direction}, c->corners, &c->plane);
    if (slope == 0 || slope == c->part->hidden)
        return false;
    if (compare_depth(p, c, at, t, error, p->near) < 0 || compare_depth(p, c, at, t, error, p->far) > 0)
        return false;
    if (!is_nearer(p, c, lane, t, error) || !is_solid(c, at->origin, at->direction))
        return false;
    at->id = c->id;
    p->depth[lane] = t;
    p->depth_error[lane] = error;
    return true;
}

static bool candidate_load(struct candidate *c, const struct candidate_part *part, uint32_t index)
{
    c->part = part;
    c->index = index;
    c->id = part->first_triangle + index;
    return candidate_corners(part, index, c->corners);
}

/* Embree's fp32 end of a line that need not be followed beyond `distance`. */
static float traversal_end(const struct line_packet *p, double distance)
{
    return distance > 0 ? (float)((distance + p->reference->margin) * (1 + 0x1p-22)) : (float)p->reference->margin;
}

void lines_meet_triangle(const struct RTCIntersectFunctionNArguments *args)
{
    struct line_packet *p = (struct line_packet *)args->context;
    struct candidate c;
    unsigned sure = 0, lanes = lane_bits(args->valid);
    assert(args->N == LANES);
    if (!candidate_load(&c, args->geometryUserPtr, args->primID))
        return;
    p->tests += (unsigned)__builtin_popcount(lanes);
    lanes = may_cross(p, c.corners, lanes, &sure);
    if (!lanes)
        return;
    c.plane = form_plane(c.corners);
    for (; lanes; lanes &= lanes - 1) {
        unsigned lane = (unsigned)__builtin_ctz(lanes);
        if (!take_if_visible(p, &c, lane, sure >> lane & 1))
            continue;
        double end = (p->depth[lane] + p->depth_error[lane]) * p->length[lane] - p->start[lane];
        float *tfar = (float *)args->rayhit + RAY_TFAR + lane;
        float nearer = traversal_end(p, end);
        if (nearer < *tfar)
            *tfar = nearer;
    }
}

static bool blocks(struct line_packet *p, const struct candidate *c, unsigned lane, bool sure_inside, bool sure_side,
                   int light_side)
{
    if (!sure_inside || !sure_side) {
        struct exact_point point = line_point(p, lane, true);
        p->exact += !sure_side;
        if (!sure_side && exact_plane_side(&point, c->corners) * light_side >= 0)
            return false;
        if (!sure_inside && !crosses_exactly(p, &point, c->corners))
            return false;
    }
    return is_solid(c, p->point[lane], p->apex.infinite ? p->apex.v : dvec3_sub(p->apex.v, p->point[lane]));
}

void lines_blocked_by_triangle(const struct RTCOccludedFunctionNArguments *args)
{
    struct line_packet *p = (struct line_packet *)args->context;
    struct candidate c;
    unsigned inside = 0, above, below, lanes = lane_bits(args->valid);
    assert(args->N == LANES);
    if (!candidate_load(&c, args->geometryUserPtr, args->primID))
        return;
    for (unsigned bits = lanes; bits; bits &= bits - 1)
        if (p->receiver[__builtin_ctz(bits)].id == c.id)
            lanes &= ~(bits & -bits);
    p->tests += (unsigned)__builtin_popcount(lanes);
    if (!lanes || !(lanes = may_cross(p, c.corners, lanes, &inside)))
        return;
    c.plane = form_plane(c.corners);
    int light_side = lines_apex_side(p, &p->apex, c.corners, &c.plane);
    if (light_side == 0)
        return;
    filter_signs(&c.plane, &p->lanes, &above, &below);
    lanes &= ~(light_side > 0 ? above : below);
    unsigned opposite = light_side > 0 ? below : above;
    for (; lanes; lanes &= lanes - 1) {
        unsigned lane = (unsigned)__builtin_ctz(lanes);
        if (blocks(p, &c, lane, inside >> lane & 1, opposite >> lane & 1, light_side))
            ((float *)args->ray)[RAY_TFAR + lane] = -INFINITY;
    }
}
