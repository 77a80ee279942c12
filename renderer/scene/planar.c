#include "scene/finish.h"

/* As in bounds.c; here of the scene's extent. */
#define PLANAR_TOLERANCE 1e-6
/* Box and triangle tests spent in all: past them a planar instance counts as lying between others, which costs accuracy of the shadow
 * maps' fit, never correctness. */
#define TEST_BUDGET      ((size_t)1 << 25)

struct plane {
    struct dvec3 normal, point;
    double tolerance;
};

struct sides {
    bool front, back; /* geometry strictly on that side */
};

static double height(const struct plane *plane, struct dvec3 p) { return dvec3_dot(dvec3_sub(p, plane->point), plane->normal); }

static void add_point(const struct plane *plane, struct dvec3 p, struct sides *sides)
{
    double h = height(plane, p);
    sides->front |= h > plane->tolerance;
    sides->back |= h < -plane->tolerance;
}

static struct sides box_sides(const struct plane *plane, const struct dbox *box)
{
    struct sides sides = {false, false};
    for (int k = 0; k < 8; k++) {
        struct dvec3 corner =
            dvec3(k & 1 ? box->max.x : box->min.x, k & 2 ? box->max.y : box->min.y, k & 4 ? box->max.z : box->min.z);
        add_point(plane, corner, &sides);
    }
    return sides;
}

/* Exact, over the triangles; used only where the box lies on both sides. */
static void add_triangles(const struct scene *scene, const struct instance *instance, const struct plane *plane,
                          struct sides *sides, size_t *budget)
{
    uint32_t triangles = scene->meshes[instance->mesh].index_count / 3;
    if (triangles >= *budget) {
        *budget = 0;
        return;
    }
    for (uint32_t t = 0; t < triangles && !(sides->front && sides->back); t++, --*budget)
        for (unsigned corner = 0; corner < 3; corner++)
            add_point(plane, instance_vertex(scene, instance, t, corner), sides);
}

/* False when the budget ran out. */
static bool sides_of_others(const struct scene *scene, const struct instance *self, const struct plane *plane,
                            struct sides *sides, size_t *budget)
{
    for (size_t i = 0; i < scene->instance_count && !(sides->front && sides->back); i++) {
        const struct instance *other = &scene->instances[i];
        if (other == self || dbox_is_empty(&other->bounds))
            continue;
        if (*budget == 0)
            return false;
        --*budget;
        struct sides box = box_sides(plane, &other->bounds);
        if (box.front && box.back) {
            add_triangles(scene, other, plane, sides, budget);
        } else {
            sides->front |= box.front;
            sides->back |= box.back;
        }
    }
    return *budget > 0;
}

static bool plane_of(const struct scene *scene, const struct instance *instance, uint32_t triangle, struct plane *out)
{
    struct dvec3 a = instance_vertex(scene, instance, triangle, 0);
    struct dvec3 b = instance_vertex(scene, instance, triangle, 1);
    struct dvec3 c = instance_vertex(scene, instance, triangle, 2);
    out->normal = dvec3_normalize(dvec3_cross(dvec3_sub(b, a), dvec3_sub(c, a)));
    out->point = a;
    out->tolerance = PLANAR_TOLERANCE * dbox_radius(&scene->bounds);
    return dvec3_finite(out->normal) && dvec3_finite(a) && dvec3_dot(out->normal, out->normal) > 0.5;
}

void scene_find_planes(struct scene *scene, const struct mesh_shape *shapes)
{
    size_t budget = TEST_BUDGET;
    for (size_t i = 0; i < scene->instance_count; i++) {
        struct instance *instance = &scene->instances[i];
        struct plane plane;
        struct sides sides = {false, false};
        instance->others_side = 0;
        if (!scene->meshes[instance->mesh].planar || !plane_of(scene, instance, shapes[instance->mesh].largest_triangle, &plane))
            continue;
        if (!sides_of_others(scene, instance, &plane, &sides, &budget) || (sides.front && sides.back))
            continue;
        instance->others_side = sides.front ? 1 : sides.back ? -1 : 2;
        instance->plane_normal = plane.normal;
        instance->plane_point = plane.point;
    }
}
