/* Shadows near to their casters and far from them, by a light that is not a point. */
#include "builtin/scenes.h"

/* What is to be seen: a box on the floor, a plate 0.5 and one 2 units above it, all in the light of a disc of radius 0.2, 5 units up. The
 * box's shadow is sharp at its foot; on the floor, straight below the light, the penumbra of an edge h units up is
 * 2 x 0.2 h / (5 - h) wide: 0.044 of the low plate, 0.267 of the high one. */
static void make_contact(struct mesh_builder *b, const double *values)
{
    (void)values;
    mesh_builder_ground(b, 12, 12, (const float[]){0.76f, 0.74f, 0.70f});
    mesh_builder_begin(b, "box", mesh_builder_material(b, "box", (const float[]){0.75f, 0.4f, 0.25f}, 0.8f, false));
    mesh_builder_box(b, dvec3(-1.7, 0, 0.3), dvec3(0.7, 0.7, 0.7), 0.3);
    mesh_builder_end(b);
    mesh_builder_begin(b, "plates", mesh_builder_material(b, "plates", (const float[]){0.3f, 0.5f, 0.65f}, 0.8f, true));
    const double x[2] = {-0.1, 1.3}, y[2] = {0.5, 2}, half = 0.5;
    for (int i = 0; i < 2; i++)
        mesh_builder_flat_quad(b, dvec3(x[i] - half, y[i], half), dvec3(x[i] + half, y[i], half), dvec3(x[i] + half, y[i], -half),
                               dvec3(x[i] - half, y[i], -half));
    mesh_builder_end(b);
    mesh_builder_point_light(b, dvec3(0.6, 5, 1.2), 400);
    if (!b->failed)
        b->lights.data[b->lights.count - 1].radius = 0.2;
    mesh_builder_camera(b, dvec3(0, 3.4, 5), dvec3(0.1, 0.5, -0.2), 0.72);
}

const struct builtin_scene builtin_contact = {
    {"contact", "A box on the floor, plates 0.5 and 2 units above it, a light of radius 0.2.", NULL}, make_contact};
