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
