/* Hard cases about the surface that receives the shadow: light that grazes it, casters that stand on it. */
#include "builtin/scenes.h"

#define PI 3.14159265358979323846

static const float grey[3] = {0.7f, 0.7f, 0.7f};

/* What is to be seen: steps so low that their shadows are 1, 2 and 4 units long whatever the angle, on a floor lit at that
 * angle. Beside them two strips: the near one (z > 0) rises away from the light by twice the angle, the far one sinks by as much.
 * Right answer: the shadows of the steps end 1, 2 and 4 units behind their back edges (within the fp32 rounding of their heights
 * over the tangent: 1e-7 relative). The rising strip is lit, and its shadow on the floor behind it is 8 units long. The sinking
 * strip has N.L = -sin(angle) < 0: it is dark all over and no receiver at all, and the floor behind it is dark for another 4
 * units. */
static void make_grazing(struct mesh_builder *b, const double *values)
{
    double angle = values[0] * PI / 180, slope = tan(angle), rise = 4 * tan(2 * angle);
    mesh_builder_ground(b, 24, 12, grey);
    mesh_builder_begin(b, "steps", mesh_builder_material(b, "steps", (const float[]){0.75f, 0.4f, 0.25f}, 0.9f, false));
    for (int i = 0; i < 3; i++)
        mesh_builder_box(b, dvec3(-2.5, 0, 0.8 * (i - 1)), dvec3(0.5, slope * (1 << i), 0.5), 0);
    mesh_builder_end(b);
    mesh_builder_begin(b, "strips", mesh_builder_material(b, "strips", (const float[]){0.3f, 0.5f, 0.65f}, 0.9f, false));
    mesh_builder_flat_quad(b, dvec3(-3, 0, 3), dvec3(1, rise, 3), dvec3(1, rise, 2), dvec3(-3, 0, 2));
    mesh_builder_flat_quad(b, dvec3(-3, rise, -2), dvec3(1, 0, -2), dvec3(1, 0, -3), dvec3(-3, rise, -3));
    mesh_builder_end(b);
    /* Bright enough to show on a floor that gets sin(angle) of it. */
    mesh_builder_directional_light(b, dvec3(cos(angle), -sin(angle), 0), (float)(3 / sin(angle)));
    mesh_builder_camera(b, dvec3(0.5, 7, 8), dvec3(0.5, 0, 0), 0.75);
}

static const struct builtin_param grazing_params[] = {
    {"degrees", "angle between the light and the floor", 0.01, 10, 0.1, false},
    {NULL},
};

const struct builtin_scene builtin_hard_grazing = {
    {"hard-01-grazing", "Light that grazes the floor: the sign of N.L decides.", grazing_params}, make_grazing};

/* What is to be seen: boxes whose bottom faces lie in the floor's own fp32 plane (y = 0 exactly), straight and turned; and a
 * sheet that stands on it on edge.
 * Right answer: every shadow starts at the foot, without a lit gap (detached shadow) and without light inside it (leak). The
 * bottom faces are coplanar with the floor, so they do not cross the floor's light paths. */
static void make_contact(struct mesh_builder *b, const double *values)
{
    (void)values;
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "boxes", mesh_builder_material(b, "boxes", (const float[]){0.75f, 0.4f, 0.25f}, 0.9f, false));
    mesh_builder_box(b, dvec3(-0.75, 0, 0), dvec3(0.5, 0.5, 0.5), 0);
    mesh_builder_box(b, dvec3(0.25, 0, 0.25), dvec3(0.4, 0.7, 0.4), 0.5);
    mesh_builder_box(b, dvec3(0.9, 0, -0.5), dvec3(0.6, 0.01, 0.3), -0.3);
    mesh_builder_end(b);
    mesh_builder_begin(b, "sheet", mesh_builder_material(b, "sheet", (const float[]){0.3f, 0.5f, 0.65f}, 0.9f, true));
    mesh_builder_flat_quad(b, dvec3(-0.5, 0, 0.9), dvec3(0, 0, 0.75), dvec3(0, 0.3, 0.75), dvec3(-0.5, 0.3, 0.9));
    mesh_builder_end(b);
    mesh_builder_point_light(b, dvec3(2.5, 3, 2), 200);
    mesh_builder_camera(b, dvec3(0.3, 1.6, 3), dvec3(0, 0.15, 0), 0.7);
}

const struct builtin_scene builtin_hard_contact = {
    {"hard-04-contact", "Boxes and a sheet standing on the floor in the same plane.", NULL}, make_contact};

/* `p` turned by `angle` about the axis (1, 2, 3). */
static struct dvec3 tilted(struct dvec3 p, double angle)
{
    const struct dvec3 axis = dvec3_normalize(dvec3(1, 2, 3));
    double c = cos(angle), s = sin(angle);
    struct dvec3 turned = dvec3_mad(dvec3_scale(p, c), dvec3_cross(axis, p), s);
    return dvec3_mad(turned, axis, dvec3_dot(axis, p) * (1 - c));
}

/* What is to be seen: the boxes on the floor again, the whole scene turned about a slanted axis before its vertices were rounded to floats: the
 * bottom faces and the floor's plane now differ by last bits.
 * Right answer: the exact one for those very floats. Box and floor cut each other by some 1e-7, so at most single pixels along a foot may
 * differ from hard-04; no lit seam, no detached shadow. */
static void make_noise(struct mesh_builder *b, const double *values)
{
    make_contact(b, values);
    if (b->failed)
        return;
    double angle = values[0] * PI / 180;
    for (size_t i = 0; i < b->positions.count; i++) {
        float *p = b->positions.data[i].v, *n = b->normals.data[i].v;
        struct dvec3 turned = tilted(dvec3_from_float(p), angle), normal = tilted(dvec3_from_float(n), angle);
        const double to[6] = {turned.x, turned.y, turned.z, normal.x, normal.y, normal.z};
        for (int k = 0; k < 3; k++) {
            p[k] = (float)to[k];
            n[k] = (float)to[3 + k];
        }
    }
    b->lights.data[0].position = tilted(b->lights.data[0].position, angle);
    struct camera *camera = &b->cameras.data[0];
    camera->eye = tilted(camera->eye, angle);
    camera->right = tilted(camera->right, angle);
    camera->up = tilted(camera->up, angle);
    camera->back = tilted(camera->back, angle);
}

static const struct builtin_param noise_params[] = {
    {"degrees", "by which the scene is turned", 0, 180, 37, false},
    {NULL},
};

const struct builtin_scene builtin_hard_noise = {
    {"hard-05-noise", "Boxes on the floor whose planes agree only up to last bits.", noise_params}, make_noise};

/* What is to be seen: a corridor of frames, seen from inside the first, whose sides the camera's near plane cuts; a sheet that starts behind the
 * eye and runs through the near plane into the picture.
 * Right answer: nothing nearer than the near plane is seen, but all of it casts: the frame around the eye and the sheet's part behind it throw
 * their shadows into the picture. */
static void make_clipped(struct mesh_builder *b, const double *values)
{
    mesh_builder_ground(b, 24, 24, grey);
    mesh_builder_begin(b, "frames", mesh_builder_material(b, "frames", (const float[]){0.75f, 0.4f, 0.25f}, 0.9f, false));
    for (int i = 0; i < 4; i++) {
        double z = 2.5 - 1.25 * i;
        mesh_builder_box(b, dvec3(-0.8, 0, z), dvec3(0.15, 1.5, 0.4), 0);
        mesh_builder_box(b, dvec3(0.8, 0, z), dvec3(0.15, 1.5, 0.4), 0);
        mesh_builder_box(b, dvec3(0, 1.5, z), dvec3(1.75, 0.15, 0.4), 0);
    }
    mesh_builder_end(b);
    mesh_builder_begin(b, "sheet", mesh_builder_material(b, "sheet", (const float[]){0.3f, 0.5f, 0.65f}, 0.9f, true));
    mesh_builder_flat_quad(b, dvec3(-0.5, 0.3, 4.5), dvec3(0.1, 0.6, 4.5), dvec3(0.3, 0.4, 1), dvec3(-0.3, 0.2, 1));
    mesh_builder_end(b);
    mesh_builder_directional_light(b, dvec3_normalize(dvec3(-0.5, -1, -0.7)), 3);
    mesh_builder_camera(b, dvec3(0, 0.9, 2.7), dvec3(0, 0.55, 0), 1.1);
    if (!b->failed)
        b->cameras.data[0].near = values[0];
}

static const struct builtin_param clipped_params[] = {
    {"near", "the camera's near plane", 0.001, 1, 0.4, false},
    {NULL},
};

const struct builtin_scene builtin_hard_clipped = {
    {"hard-24-clipped", "Geometry cut by the camera's near plane.", clipped_params}, make_clipped};
