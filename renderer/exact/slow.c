#include "exact/slow.h"

#include "reference/rules.h"

static struct exact_point own_point(const struct slow *s, const struct sample_ray *ray)
{
    return s->view->orthographic ? (struct exact_point){.kind = EXACT_POINT, .v = ray->origin}
                                 : (struct exact_point){.kind = EXACT_DIRECTION, .v = ray->direction};
}

static struct exact_point plane_point(const struct slow *s, const struct sample_ray *ray, uint32_t id)
{
    struct exact_point p = {.kind = EXACT_ON_PLANE, .ray_origin = ray->origin, .ray_direction = ray->direction};
    triangle_corners(s->triangles, id, p.plane);
    return p;
}

static bool passes_inside(const struct exact_apex *apex, const struct exact_point *point, const struct dvec3 c[3])
{
    int first = exact_edge_side(apex, point, c[0], c[1]);
    return first != 0 && exact_edge_side(apex, point, c[1], c[2]) == first && exact_edge_side(apex, point, c[2], c[0]) == first;
}

bool slow_crosses(struct slow *s, const struct sample_ray *ray, uint32_t id)
{
    struct dvec3 c[3];
    struct exact_apex eye = {s->view->orthographic, s->view->orthographic ? s->view->forward : s->view->eye};
    struct exact_point point = own_point(s, ray);
    triangle_corners(s->triangles, id, c);
    s->exact++;
    return passes_inside(&eye, &point, c);
}

/* Sign of N . v for a direction, or N . (v - a). */
static int side_of(struct slow *s, bool infinite, struct dvec3 v, const struct dvec3 c[3])
{
    struct form plane = form_plane(c);
    double error, value = infinite ? form_slope(&plane, v, &error) : form_value(&plane, v, 0, &error);
    if (fabs(value) > error)
        return value > 0 ? 1 : -1;
    s->exact++;
    return exact_apex_side(&(struct exact_apex){infinite, v}, c);
}

/* Certain sign of t - limit. */
static int compare_limit(struct slow *s, const struct sample_ray *ray, const struct dvec3 c[3], double limit)
{
    struct form plane = form_plane(c);
    double error, t = form_depth(&plane, ray->origin, ray->direction, &error);
    if (isinf(limit) || fabs(t - limit) > error + 0x1p-50 * fabs(limit))
        return t > limit ? 1 : -1;
    s->exact++;
    return exact_compare_depth(ray->origin, ray->direction, c, limit);
}

static bool is_solid(const struct slow *s, uint32_t id, const struct dvec3 c[3], struct dvec3 origin, struct dvec3 direction)
{
    if (!(s->triangles->flags[id] & TRIANGLE_HOLES))
        return true;
    const struct scene *scene = s->triangles->scene;
    uint32_t instance = scene_instance_of(scene, id);
    return rule_is_solid(scene, instance, id - scene->instances[instance].first_triangle, c, origin, direction);
}

bool slow_meets(struct slow *s, const struct sample_ray *ray, uint32_t id)
{
    struct dvec3 c[3];
    triangle_corners(s->triangles, id, c);
    unsigned flags = s->triangles->flags[id];
    int slope = side_of(s, true, ray->direction, c);
    int hidden = flags & TRIANGLE_HIDDEN_BACK ? 1 : flags & TRIANGLE_HIDDEN_MIRRORED ? -1 : 0;
    return slope != 0 && slope != hidden && compare_limit(s, ray, c, s->view->near) >= 0 &&
           compare_limit(s, ray, c, s->view->far) <= 0 && is_solid(s, id, c, ray->origin, ray->direction);
}

bool slow_sees_solid(const struct slow *s, const struct sample_ray *ray, uint32_t id)
{
    struct dvec3 c[3];
    triangle_corners(s->triangles, id, c);
    return is_solid(s, id, c, ray->origin, ray->direction);
}

bool slow_is_before(struct slow *s, const struct sample_ray *ray, uint32_t first, uint32_t second)
{
    struct dvec3 a[3], b[3];
    triangle_corners(s->triangles, first, a);
    triangle_corners(s->triangles, second, b);
    struct form pa = form_plane(a), pb = form_plane(b);
    double ea, ta = form_depth(&pa, ray->origin, ray->direction, &ea), eb, tb = form_depth(&pb, ray->origin, ray->direction, &eb);
    if (fabs(ta - tb) > ea + eb)
        return ta < tb;
    s->exact++;
    int order = exact_compare_depths(ray->origin, ray->direction, a, b);
    return order < 0 || (order == 0 && first < second);
}

int slow_light_side(struct slow *s, uint32_t id)
{
    struct dvec3 c[3];
    triangle_corners(s->triangles, id, c);
    return side_of(s, s->to_light.infinite, s->to_light.v, c);
}

bool slow_receives(struct slow *s, const struct sample_ray *ray, uint32_t receiver)
{
    struct dvec3 c[3];
    if (receiver == SCENE_NONE || s->triangles->flags[receiver] & TRIANGLE_IGNORED)
        return false;
    triangle_corners(s->triangles, receiver, c);
    return side_of(s, true, ray->direction, c) * slow_light_side(s, receiver) < 0 &&
           rule_within_reach(s->light, rule_point(ray->origin, ray->direction, c));
}

bool slow_is_solid(const struct slow *s, const struct sample_ray *ray, uint32_t receiver, uint32_t occluder)
{
    struct dvec3 own[3], c[3];
    if (!(s->triangles->flags[occluder] & TRIANGLE_HOLES))
        return true;
    triangle_corners(s->triangles, receiver, own);
    triangle_corners(s->triangles, occluder, c);
    struct dvec3 point = rule_point(ray->origin, ray->direction, own);
    return is_solid(s, occluder, c, point, s->to_light.infinite ? s->to_light.v : dvec3_sub(s->to_light.v, point));
}

bool slow_blocks(struct slow *s, const struct sample_ray *ray, uint32_t receiver, uint32_t occluder, int light_side)
{
    struct dvec3 c[3];
    struct exact_point point = plane_point(s, ray, receiver);
    triangle_corners(s->triangles, occluder, c);
    s->exact++;
    return exact_plane_side(&point, c) * light_side < 0 && passes_inside(&s->to_light, &point, c) &&
           slow_is_solid(s, ray, receiver, occluder);
}
