/* Where lines start and end, and how they are given to Embree. */
#include "reference/lines.h"

struct span {
    double from, to;
};

static void clip_axis(struct span *s, double origin, double direction, double low, double high)
{
    if (direction == 0) {
        if (origin < low || origin > high)
            s->to = -INFINITY;
        return;
    }
    double a = (low - origin) / direction, b = (high - origin) / direction;
    s->from = fmax(s->from, fmin(a, b));
    s->to = fmin(s->to, fmax(a, b));
}

/* Sets the lane's fp32 ray along `unit` from `origin` over `span`, clipped to the scene's box; false when nothing is left. */
static bool set_ray(struct line_packet *p, struct RTCRay16 *ray, unsigned lane, struct dvec3 origin, struct dvec3 unit,
                    struct span span)
{
    const struct reference *r = p->reference;
    if (dbox_is_empty(&r->box))
        return false;
    clip_axis(&span, origin.x, unit.x, r->box.min.x, r->box.max.x);
    clip_axis(&span, origin.y, unit.y, r->box.min.y, r->box.max.y);
    clip_axis(&span, origin.z, unit.z, r->box.min.z, r->box.max.z);
    if (!(span.from <= span.to))
        return false;
    struct dvec3 start = dvec3_mad(origin, unit, span.from);
    p->start[lane] = span.from;
    ray->org_x[lane] = (float)start.x;
    ray->org_y[lane] = (float)start.y;
    ray->org_z[lane] = (float)start.z;
    ray->dir_x[lane] = (float)unit.x;
    ray->dir_y[lane] = (float)unit.y;
    ray->dir_z[lane] = (float)unit.z;
    ray->tnear[lane] = 0;
    ray->tfar[lane] = (float)((span.to - span.from + r->margin) * (1 + 0x1p-22));
    ray->time[lane] = 0;
    ray->mask[lane] = ~0u;
    ray->id[lane] = lane;
    ray->flags[lane] = 0;
    return true;
}

static void packet_begin(struct line_packet *p, int valid[LANES])
{
    rtcInitIntersectContext(&p->base);
    p->base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (unsigned i = 0; i < LANES; i++)
        valid[i] = 0;
}

/* Lanes that are not used still go through the filter: they need numbers. */
static void lane_clear(struct lanes *lanes, unsigned lane)
{
    lanes->x[lane] = lanes->y[lane] = lanes->z[lane] = lanes->error[lane] = 0;
}

void lines_find_visible(struct line_packet *p, const struct view *view, unsigned active)
{
    int valid[LANES] __attribute__((aligned(64)));
    struct RTCRayHit16 packet;
    bool any = false;
    packet_begin(p, valid);
    p->directions = !view->orthographic;
    p->apex = (struct exact_apex){.infinite = view->orthographic, .v = view->orthographic ? view->forward : view->eye};
    p->near = view->near;
    p->far = view->far;
    for (unsigned lane = 0; lane < LANES; lane++) {
        struct receiver *at = &p->receiver[lane];
        at->id = SCENE_NONE;
        packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        lane_clear(&p->lanes, lane);
        if (!(active >> lane & 1))
            continue;
        struct dvec3 own = p->directions ? at->direction : at->origin;
        p->lanes.x[lane] = own.x;
        p->lanes.y[lane] = own.y;
        p->lanes.z[lane] = own.z;
        double length = p->length[lane] = dvec3_length(at->direction);
        struct span span = {view->near * length - p->reference->margin, view->far * length + p->reference->margin};
        if (set_ray(p, &packet.ray, lane, at->origin, dvec3_scale(at->direction, 1 / length), span))
            any = true, valid[lane] = -1;
    }
    if (any)
        rtcIntersect16(valid, p->reference->tree, &p->base, &packet);
}

unsigned lines_find_shadowed(struct line_packet *p, const struct light *light, unsigned active)
{
    int valid[LANES] __attribute__((aligned(64)));
    struct RTCRay16 ray;
    unsigned shadowed = 0;
    bool any = false;
    packet_begin(p, valid);
    p->directions = false;
    p->apex = light_apex(light);
    for (unsigned lane = 0; lane < LANES; lane++) {
        if (!(active >> lane & 1)) {
            lane_clear(&p->lanes, lane);
            continue;
        }
        struct dvec3 from = dvec3(p->lanes.x[lane], p->lanes.y[lane], p->lanes.z[lane]);
        struct dvec3 to = p->apex.infinite ? p->apex.v : dvec3_sub(p->apex.v, from);
        double length = dvec3_length(to);
        struct span span = {0, p->apex.infinite ? INFINITY : length};
        if (length > 0 && set_ray(p, &ray, lane, from, dvec3_scale(to, 1 / length), span))
            any = true, valid[lane] = -1;
    }
    if (!any)
        return 0;
    rtcOccluded16(valid, p->reference->tree, &p->base, &ray);
    for (unsigned lane = 0; lane < LANES; lane++)
        shadowed |= (unsigned)(valid[lane] && ray.tfar[lane] < 0) << lane;
    return shadowed;
}
