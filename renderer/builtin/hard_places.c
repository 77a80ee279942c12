/* Hard cases about where in the world a scene lies, and how large it is. */
#include "builtin/scenes.h"

static const float grey[3] = {0.7f, 0.7f, 0.7f};
static const float clay[3] = {0.75f, 0.4f, 0.25f};

/* All numbers are dyadic, so that moving by a whole number far out rounds nothing. */
static void add_arch(struct mesh_builder *b)
{
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "arch", mesh_builder_material(b, "clay", clay, 0.9f, false));
    mesh_builder_box(b, dvec3(-0.75, 0, 0), dvec3(0.25, 1, 0.25), 0);
    mesh_builder_box(b, dvec3(0.75, 0, 0), dvec3(0.25, 1, 0.25), 0);
    mesh_builder_box(b, dvec3(0, 1, 0), dvec3(2, 0.125, 0.5), 0);
    mesh_builder_box(b, dvec3(0.125, 0, 0.75), dvec3(0.5, 0.25, 0.5), 0);
    mesh_builder_end(b);
    mesh_builder_point_light(b, dvec3(2.5, 3.75, 2.125), 200);
    mesh_builder_camera(b, dvec3(0, 2.25, 4.75), dvec3(0, 0.5, 0), 0.6);
}

/* What is to be seen: an arch and a block, the whole scene (nodes, light, camera) moved by `offset` along x and z.
 * Right answer: the same picture, bit for bit, at every whole offset: vertices are local to their node and everything is made relative to
 * the camera in double. */
static void make_offset(struct mesh_builder *b, const double *values)
{
    add_arch(b);
    mesh_builder_move(b, dvec3(values[0], 0, -values[0]));
}

static const struct builtin_param offset_params[] = {
    {"offset", "how far the scene is moved along x and -z", 0, 1e7, 1e6, true},
    {NULL},
};

const struct builtin_scene builtin_hard_offset = {{"hard-15-offset", "A scene moved far from the world's origin.", offset_params},
                                                  make_offset};

/* What is to be seen: the same arch, `scale` times as large.
 * Right answer: the same picture; exactly so for a power of two. */
static void make_scale(struct mesh_builder *b, const double *values)
{
    add_arch(b);
    mesh_builder_scale(b, values[0]);
}

static const struct builtin_param scale_params[] = {
    {"scale", "how many times as large the scene is", 1e-4, 1e4, 1e4, false},
    {NULL},
};

const struct builtin_scene builtin_hard_scale = {
    {"hard-16-scale", "A scene as large as a county, or as small as an ant.", scale_params}, make_scale};
