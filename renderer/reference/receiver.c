/* What makes a sample a receiver for a light: docs/truth.md, "Receivers". */
#include "reference/lines.h"
#include "reference/rules.h"

static double largest(struct dvec3 v) { return fmax(fmax(fabs(v.x), fabs(v.y)), fabs(v.z)); }

/* The point in double and what bounds its error, into the lane; by exact arithmetic where the bound would not be small. */
static void place_point(struct line_packet *p, unsigned lane, const struct form *plane, const struct dvec3 corners[3])
{
    const struct receiver *at = &p->receiver[lane];
    double t_error, t = form_depth(plane, at->origin, at->direction, &t_error);
    struct dvec3 point = dvec3_mad(at->origin, at->direction, t);
    double d = largest(at->direction);
    double error = d * t_error + 0x1p-51 * (d * fabs(t) + largest(point));
    p->point[lane] = point;
    if (!(error < p->reference->scale * 0x1p-32)) {
        struct exact_point exact = {.kind = EXACT_ON_PLANE,
                                    .ray_origin = at->origin,
                                    .ray_direction = at->direction,
                                    .plane = {corners[0], corners[1], corners[2]}};
        point = exact_round_point(&exact);
        error = 0x1p-51 * largest(point);
        p->exact++;
    }
    p->lanes.x[lane] = point.x;
    p->lanes.y[lane] = point.y;
    p->lanes.z[lane] = point.z;
    p->lanes.error[lane] = error;
}

bool lines_aim_at_light(struct line_packet *p, const struct light *light, unsigned lane)
{
    const struct receiver *at = &p->receiver[lane];
    if (at->id == SCENE_NONE)
        return false;
    const struct candidate_part *part = candidate_part_of(p->reference, at->id);
    struct dvec3 corners[3];
    if (!candidate_corners(part, at->id - part->first_triangle, corners))
        return false;
    struct form plane = form_plane(corners);
    const struct exact_apex ray = {true, at->direction}, to_light = light_apex(light);
    int slope = lines_apex_side(p, &ray, corners, &plane), side = lines_apex_side(p, &to_light, corners, &plane);
    if (slope * side >= 0)
        return false;
    place_point(p, lane, &plane, corners);
    return rule_within_reach(light, p->point[lane]);
}
