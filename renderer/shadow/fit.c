#include "shadow/fit.h"

#include <math.h>
#include <string.h>

/* One map serves up to this half angle (contract: all casters within 120 degrees). */
#define HALF_ANGLE_MAX   (M_PI / 3)
/* Room around a fit, so that a vertex on the border is inside after rounding: a fraction of the extent. */
#define MARGIN           1e-4
/* The same along a directional light, at least: a fraction of the scene's radius. Casters in one plane across the light have no extent there, and
 * depths of single precision over less than their own rounding are all cut off. */
#define DEPTH_ROOM       1e-5
/* Nearest depth of a map against its farthest, when casters come arbitrarily near the light. */
#define NEAR_RATIO       1e-6
/* Steps towards a cone around the casters' boxes. Where that is too wide, but not by so much, their vertices decide, in at most so many
 * steps and looks at a vertex, so that a large scene does not hold up a frame. */
#define CONE_STEPS       12
#define CONE_NEARLY      (1.4 * HALF_ANGLE_MAX)
#define VERTEX_STEPS_MAX 200
#define VERTEX_LOOKS_MAX ((size_t)1 << 23)

static bool casts(const struct instance *instance, const struct light *light)
{
    if (dbox_is_empty(&instance->bounds))
        return false;
    if (instance->others_side == 0)
        return true;
    if (instance->others_side == 2)
        return false;
    double side = light->kind == LIGHT_DIRECTIONAL
                      ? -dvec3_dot(instance->plane_normal, light->direction)
                      : dvec3_dot(instance->plane_normal, dvec3_sub(light->position, instance->plane_point));
    /* 0: a light in the plane sees it edge-on. */
    return side * instance->others_side < 0;
}

/* False only if the box lies outside the cone for certain: its bounding sphere against the cone. */
static bool touches_cone(const struct dbox *box, const struct light *l)
{
    struct dvec3 v = dvec3_sub(dbox_center(box), l->position);
    double distance = dvec3_length(v), radius = dbox_radius(box);
    if (distance <= radius)
        return true;
    double angle = acos(fmax(-1, fmin(1, dvec3_dot(v, l->direction) / distance)));
    return angle <= l->outer + asin(radius / distance);
}

static bool in_range(const struct dbox *box, const struct light *l)
{
    return l->range == 0 || dvec3_length(dvec3_sub(dbox_center(box), l->position)) <= l->range + dbox_radius(box);
}

/* Bounds may hold vertices of triangles that are not finite; the boxes hold none. */
static bool has_boxes(const struct fit_geometry *g, const struct instance *instance)
{
    return g->first_box[instance->mesh] < g->first_box[instance->mesh + 1];
}

static size_t find_casters(const struct fit_geometry *g, const struct light *light, uint32_t *out)
{
    size_t n = 0;
    for (uint32_t i = 0; i < g->scene->instance_count; i++) {
        const struct instance *instance = &g->scene->instances[i];
        if (!has_boxes(g, instance) || !casts(instance, light))
            continue;
        if (light->kind != LIGHT_DIRECTIONAL && !in_range(&instance->bounds, light))
            continue;
        if (light->kind == LIGHT_SPOT && !touches_cone(&instance->bounds, light))
            continue;
        out[n++] = i;
    }
    return n;
}

/* What is fitted to. */
struct caster_set {
    const struct fit_geometry *geometry;
    const struct light *light;
    const uint32_t *casters;
    size_t count;
    bool vertices; /* look at the vertices, not at the boxes around them */
};

static void for_vertices(const struct scene *scene, const struct instance *instance, void (*visit)(void *context, struct dvec3 p),
                         void *context)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    for (size_t v = mesh->first_vertex; v < (size_t)mesh->first_vertex + mesh->vertex_count; v++) {
        struct dvec3 p = dvec3_from_float(scene->positions[v]);
        if (dvec3_finite(p))
            visit(context, affine_point(&instance->to_scene, p));
    }
}

/* Calls visit for the corners of every box of every caster (or for its vertices), scene space. For all, a spot's too: boxes hold vertices, and a
 * triangle reaches where none of its vertices is. */
static void for_corners(const struct caster_set *set, void (*visit)(void *context, struct dvec3 p), void *context)
{
    const struct fit_geometry *g = set->geometry;
    for (size_t k = 0; k < set->count; k++) {
        const struct instance *instance = &g->scene->instances[set->casters[k]];
        if (set->vertices) {
            for_vertices(g->scene, instance, visit, context);
            continue;
        }
        for (size_t b = g->first_box[instance->mesh]; b < g->first_box[instance->mesh + 1]; b++) {
            const struct fit_box *box = &g->boxes[b];
            for (int c = 0; c < 8; c++)
                visit(context, affine_point(&instance->to_scene,
                                            dvec3(c & 1 ? box->max[0] : box->min[0], c & 2 ? box->max[1] : box->min[1],
                                                  c & 4 ? box->max[2] : box->min[2])));
        }
    }
}

static size_t count_vertices(const struct caster_set *set)
{
    const struct scene *scene = set->geometry->scene;
    size_t sum = 0;
    for (size_t k = 0; k < set->count; k++)
        sum += scene->meshes[scene->instances[set->casters[k]].mesh].vertex_count;
    return sum;
}

/* Axes that look along `forward`. Up is scene Y where that is possible. */
static void look_along(struct view *v, struct dvec3 forward)
{
    struct dvec3 up = fabs(forward.y) < 0.99 ? dvec3(0, 1, 0) : dvec3(0, 0, -1);
    v->forward = forward;
    v->right = dvec3_normalize(dvec3_cross(forward, up));
    v->up = dvec3_cross(v->right, v->forward);
}

struct extents {
    const struct view *view;
    double min_x, max_x, min_y, max_y, min_z, max_z;
    double widest; /* largest angle to the axis, radians (perspective) */
};

static struct extents no_extents(const struct view *v)
{
    return (struct extents){v, INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY, 0};
}

static void extend(void *context, struct dvec3 p)
{
    struct extents *e = context;
    struct dvec3 d = dvec3_sub(p, e->view->eye);
    double x = dvec3_dot(d, e->view->right), y = dvec3_dot(d, e->view->up), z = dvec3_dot(d, e->view->forward);
    if (!e->view->orthographic) {
        e->widest = fmax(e->widest, atan2(hypot(x, y), z));
        if (z > 0) {
            x /= z;
            y /= z;
        }
    }
    e->min_x = fmin(e->min_x, x);
    e->max_x = fmax(e->max_x, x);
    e->min_y = fmin(e->min_y, y);
    e->max_y = fmax(e->max_y, y);
    e->min_z = fmin(e->min_z, z);
    e->max_z = fmax(e->max_z, z);
}

static void set_picture(struct view *v, const struct extents *e)
{
    double mx = MARGIN * (e->max_x - e->min_x) + 1e-12, my = MARGIN * (e->max_y - e->min_y) + 1e-12;
    v->left = e->min_x - mx;
    v->right_edge = e->max_x + mx;
    v->bottom = e->min_y - my;
    v->top = e->max_y + my;
}

static void set_depths(struct view *v, double nearest, double farthest)
{
    v->far = INFINITY;
    v->near = fmax(nearest * (1 - MARGIN), farthest * NEAR_RATIO);
    if (!(v->near > 0))
        v->near = 1e-12;
}

static void fit_directional(const struct caster_set *set, bool cube, struct shadow_fit *out)
{
    const struct dbox *bounds = &set->geometry->scene->bounds;
    struct view *v = &out->maps[0];
    v->orthographic = true;
    v->eye = dbox_center(bounds);
    look_along(v, set->light->direction);
    struct extents e = no_extents(v);
    for_corners(set, extend, &e);
    if (cube) {
        double r = dbox_radius(bounds);
        e.min_x = e.min_y = -r;
        e.max_x = e.max_y = r;
    }
    double mz = MARGIN * (e.max_z - e.min_z) + DEPTH_ROOM * dbox_radius(bounds) + 1e-12;
    set_picture(v, &e);
    v->near = e.min_z - mz;
    v->far = e.max_z + mz;
    out->map_count = 1;
}

struct direction_sum {
    struct dvec3 eye, sum;
    double worst; /* cosine to `axis` */
    struct dvec3 axis, farthest;
};

static void find_farthest(void *context, struct dvec3 p)
{
    struct direction_sum *s = context;
    struct dvec3 d = dvec3_normalize(dvec3_sub(p, s->eye));
    double c = dvec3_dot(d, s->axis);
    if (c < s->worst) {
        s->worst = c;
        s->farthest = d;
    }
}

/* Moves `axis` towards that of the smallest cone around all corners: Badoiu and Clarkson 2003's steps to the farthest, on the unit sphere. */
static struct dvec3 improve_axis(const struct caster_set *set, struct dvec3 axis, int first_step, int end_step)
{
    struct direction_sum s = {.eye = set->light->position, .axis = axis};
    for (int step = first_step; step < end_step; step++) {
        s.worst = 2;
        for_corners(set, find_farthest, &s);
        s.axis = dvec3_normalize(dvec3_mad(s.axis, dvec3_sub(s.farthest, s.axis), 1.0 / (step + 1)));
    }
    return s.axis;
}

/* Extents of the casters as seen along `axis`. */
static struct extents look_at_casters(const struct caster_set *set, struct view *v, struct dvec3 axis)
{
    v->eye = set->light->position;
    look_along(v, axis);
    struct extents e = no_extents(v);
    for_corners(set, extend, &e);
    return e;
}

static double full_angle(const struct view *v)
{
    double x = atan(v->right_edge) - atan(v->left), y = atan(v->top) - atan(v->bottom);
    return fmax(x, y) * 180 / M_PI;
}

static void finish_perspective(struct shadow_fit *out, const struct extents *e)
{
    set_picture(&out->maps[0], e);
    set_depths(&out->maps[0], e->min_z, e->max_z);
    out->fov_deg[0] = full_angle(&out->maps[0]);
    out->map_count = 1;
}

/* A narrow spot's casters reach beyond its cone: only the part inside counts, so the picture is the meeting of both. */
static void fit_narrow_spot(const struct caster_set *set, struct shadow_fit *out)
{
    struct extents e = look_at_casters(set, &out->maps[0], set->light->direction);
    double t = tan(set->light->outer);
    bool behind = e.min_z <= 0;
    e.min_x = behind ? -t : fmax(e.min_x, -t);
    e.max_x = behind ? t : fmin(e.max_x, t);
    e.min_y = behind ? -t : fmax(e.min_y, -t);
    e.max_y = behind ? t : fmin(e.max_y, t);
    if (e.min_x < e.max_x && e.min_y < e.max_y && e.max_z > 0)
        finish_perspective(out, &e);
}

/* False: the casters do not lie within one map's angle. */
static bool fit_one_perspective(const struct caster_set *set, struct shadow_fit *out)
{
    struct view *v = &out->maps[0];
    const struct instance *any = &set->geometry->scene->instances[set->casters[0]];
    struct dvec3 axis = dvec3_normalize(dvec3_sub(dbox_center(&any->bounds), set->light->position));
    if (dvec3_dot(axis, axis) == 0)
        axis = dvec3(0, -1, 0);
    axis = improve_axis(set, axis, 1, CONE_STEPS + 1);
    struct extents e = look_at_casters(set, v, axis);
    if (e.widest > HALF_ANGLE_MAX && e.widest < CONE_NEARLY) {
        struct caster_set exact = *set;
        exact.vertices = true;
        size_t affordable = VERTEX_LOOKS_MAX / (count_vertices(set) + 1);
        axis = improve_axis(&exact, axis, CONE_STEPS + 1,
                            CONE_STEPS + (affordable < VERTEX_STEPS_MAX ? (int)affordable : VERTEX_STEPS_MAX));
        e = look_at_casters(&exact, v, axis);
    }
    if (e.widest > HALF_ANGLE_MAX)
        return false;
    finish_perspective(out, &e);
    return true;
}

struct face_use {
    const struct view *view;
    double nearest, farthest;
    bool outside[4]; /* all corners beyond the plane */
    bool behind;
};

static void use_face(void *context, struct dvec3 p)
{
    struct face_use *u = context;
    struct dvec3 d = dvec3_sub(p, u->view->eye);
    double x = dvec3_dot(d, u->view->right), y = dvec3_dot(d, u->view->up), z = dvec3_dot(d, u->view->forward);
    u->outside[0] &= x < -z;
    u->outside[1] &= x > z;
    u->outside[2] &= y < -z;
    u->outside[3] &= y > z;
    u->behind &= z < 0;
    u->nearest = fmin(u->nearest, z);
    u->farthest = fmax(u->farthest, z);
}

/* Caster by caster: one that lies wholly beyond a side plane is not in the face. */
static bool face_holds_casters(const struct caster_set *set, struct view *v)
{
    bool any = false;
    double farthest = 0, nearest = INFINITY;
    for (size_t k = 0; k < set->count; k++) {
        struct caster_set one = {set->geometry, set->light, set->casters + k, 1, false};
        struct face_use u = {v, INFINITY, -INFINITY, {true, true, true, true}, true};
        for_corners(&one, use_face, &u);
        if (u.outside[0] || u.outside[1] || u.outside[2] || u.outside[3] || u.behind)
            continue;
        any = true;
        farthest = fmax(farthest, u.farthest);
        nearest = fmin(nearest, u.nearest);
    }
    if (any)
        set_depths(v, fmax(nearest, 0), farthest);
    return any;
}

/* False only if the face lies outside the cone for certain: the cone around a face has a half angle of atan(sqrt(2)). */
static bool face_meets_cone(const struct light *light, struct dvec3 axis)
{
    return light->kind != LIGHT_SPOT ||
           acos(fmax(-1, fmin(1, dvec3_dot(axis, light->direction)))) <= light->outer + atan(M_SQRT2);
}

/* The faces overlap by a fraction of a texel, so that no point falls between two of them by rounding. */
static void fit_cube_faces(const struct caster_set *set, struct shadow_fit *out)
{
    static const double axes[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const double edge = 1 + MARGIN;
    out->map_count = 0;
    for (int face = 0; face < 6; face++) {
        struct view *v = &out->maps[out->map_count];
        uint32_t size = v->width;
        *v = (struct view){.width = size,
                           .height = size,
                           .eye = set->light->position,
                           .left = -edge,
                           .right_edge = edge,
                           .bottom = -edge,
                           .top = edge};
        look_along(v, dvec3(axes[face][0], axes[face][1], axes[face][2]));
        if (face_meets_cone(set->light, v->forward) && face_holds_casters(set, v))
            out->fov_deg[out->map_count++] = 90;
    }
}

/* From so far away, single precision relative to the light is coarser than taking its rays for parallel. With r the scene's radius and D the
 * distance: the former loses about 2^-24 D, the latter moves a shadow by at most 2 r^2 / D. They meet near 6000 r. */
#define PARALLEL_RADII 8192

static bool rays_are_parallel(const struct scene *scene, const struct light *light, struct light *parallel)
{
    struct dvec3 away = dvec3_sub(dbox_center(&scene->bounds), light->position);
    *parallel = *light;
    parallel->kind = LIGHT_DIRECTIONAL;
    parallel->direction = light->kind == LIGHT_DIRECTIONAL ? light->direction : dvec3_normalize(away);
    return light->kind == LIGHT_DIRECTIONAL || dvec3_length(away) > PARALLEL_RADII * dbox_radius(&scene->bounds);
}

void shadow_fit_compute(const struct fit_geometry *g, const struct light *light, uint32_t size, bool cube, uint32_t *casters,
                        struct shadow_fit *out)
{
    memset(out, 0, sizeof *out);
    for (int i = 0; i < SHADOW_MAPS_MAX; i++)
        out->maps[i].width = out->maps[i].height = size;
    out->casters = casters;
    out->caster_count = find_casters(g, light, casters);
    if (out->caster_count == 0)
        return;
    struct caster_set set = {g, light, casters, out->caster_count, false};
    struct light parallel;
    struct caster_set lit_in_parallel = {g, &parallel, casters, out->caster_count, false};
    if (rays_are_parallel(g->scene, light, &parallel))
        fit_directional(&lit_in_parallel, cube, out);
    else if (!cube && light->kind == LIGHT_SPOT && light->outer <= HALF_ANGLE_MAX)
        fit_narrow_spot(&set, out);
    else if (cube || !fit_one_perspective(&set, out))
        fit_cube_faces(&set, out);
}
