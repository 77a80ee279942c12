/* The scene that is shown when none is named. */
#include "builtin/scenes.h"

struct placed_box {
    double x, y, z; /* middle of the bottom face */
    double width, height, depth;
    double turn; /* radians */
    float rgb[3];
};

static const struct placed_box boxes[] = {
    /* An arch, */
    {-0.95, 0, -0.35, 0.26, 1.15, 0.26, 0, {0.80, 0.34, 0.20}},
    {0.15, 0, -0.35, 0.26, 1.15, 0.26, 0, {0.80, 0.34, 0.20}},
    {-0.40, 1.15, -0.35, 1.56, 0.20, 0.34, 0, {0.86, 0.62, 0.24}},
    /* three blocks on one another, */
    {1.15, 0, 0.05, 0.62, 0.42, 0.62, 0.35, {0.16, 0.42, 0.50}},
    {1.17, 0.42, 0.03, 0.44, 0.34, 0.44, 0.85, {0.24, 0.56, 0.54}},
    {1.14, 0.76, 0.05, 0.28, 0.26, 0.28, 0.20, {0.62, 0.76, 0.60}},
    /* and some that lie about. */
    {-0.40, 0, 0.62, 0.34, 0.34, 0.34, 0.60, {0.66, 0.20, 0.26}},
    {0.28, 0, 0.95, 0.80, 0.10, 0.20, -0.45, {0.86, 0.62, 0.24}},
    {-1.35, 0, 0.55, 0.30, 0.62, 0.30, 0.30, {0.30, 0.36, 0.60}},
};

static void make_box(struct mesh_builder *b, const double *values)
{
    (void)values;
    const float white[3] = {1, 1, 1};
    mesh_builder_begin_colored(b, "boxes", mesh_builder_material(b, "painted wood", white, 0.7f, false));
    for (size_t i = 0; i < sizeof boxes / sizeof boxes[0]; i++) {
        const struct placed_box *box = &boxes[i];
        mesh_builder_color(b, box->rgb[0], box->rgb[1], box->rgb[2]);
        mesh_builder_box(b, dvec3(box->x, box->y, box->z), dvec3(box->width, box->height, box->depth), box->turn);
    }
    mesh_builder_end(b);
    mesh_builder_stage(b);
}

const struct builtin_scene builtin_box = {{"box", "Coloured boxes standing on the ground.", NULL}, make_box};
