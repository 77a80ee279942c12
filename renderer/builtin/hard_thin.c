/* Hard cases about shapes that are thinner than a pixel or a texel, or lie in one another. */
#include "builtin/scenes.h"

#define PI 3.14159265358979323846

static const float grey[3] = {0.7f, 0.7f, 0.7f};
static const float clay[3] = {0.75f, 0.4f, 0.25f};
static const float slate[3] = {0.3f, 0.5f, 0.65f};

/* An upright panel at z from x0 to x1, one quad. */
static void add_panel(struct mesh_builder *b, double x0, double x1, double y0, double y1, double z)
{
    mesh_builder_flat_quad(b, dvec3(x0, y0, z), dvec3(x1, y0, z), dvec3(x1, y1, z), dvec3(x0, y1, z));
}

/* What is to be seen: an upright panel whose middle seam is filled with 16 triangles of the given aspect; beside it a spray of loose slivers.
 * Right answer: the panel's shadow is dark without a lit line where the slivers lie; the loose slivers' shadows are far thinner than a
 * pixel, hit by a pixel centre only by chance, and then dark. */
static void make_sliver(struct mesh_builder *b, const double *values)
{
    const double height = 0.8, width = height / values[0];
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "panel", mesh_builder_material(b, "panel", clay, 0.9f, true));
    add_panel(b, -1.3, -0.7, 0.2, 0.2 + height, 0);
    for (int i = 0; i < 8; i++)
        add_panel(b, -0.7 + width * i, -0.7 + width * (i + 1), 0.2, 0.2 + height, 0);
    add_panel(b, -0.7 + width * 8, -0.1, 0.2, 0.2 + height, 0);
    mesh_builder_end(b);
    mesh_builder_begin(b, "spray", mesh_builder_material(b, "spray", slate, 0.9f, true));
    for (uint32_t i = 0; i < 400; i++) {
        double angle = 2 * PI * hash_unit(i), lean = 0.2 + 0.6 * hash_unit(i + 1000);
        struct dvec3 root = {0.9, 0.1, 0}, along = {lean * cos(angle), 0.8, lean * sin(angle)};
        struct dvec3 tip = dvec3_mad(root, along, 1);
        struct dvec3 across = dvec3_scale(dvec3_normalize(dvec3(-sin(angle), 0, cos(angle))), width);
        mesh_builder_flat_triangle(b, root, dvec3_add(tip, across), tip);
    }
    mesh_builder_end(b);
    mesh_builder_point_light(b, dvec3(1.5, 3.5, 2.5), 150);
    mesh_builder_camera(b, dvec3(0, 1.9, 3.8), dvec3(0, 0.3, -0.3), 0.7);
}

static const struct builtin_param sliver_params[] = {
    {"aspect", "length over width of the slivers", 1e4, 1e6, 1e5, false},
    {NULL},
};

const struct builtin_scene builtin_hard_sliver = {
    {"hard-03-sliver", "Triangles ten thousand to a million times as long as they are wide.", sliver_params}, make_sliver};

/* What is to be seen: two panels, each a large triangle pair on the left and smaller ones on the right whose extra vertex lies on the left
 * one's edge (a T-junction): on the upper panel as near as floats come, on the lower one `gap` off it.
 * Right answer: the crack is a hole. Light passes it as rays do: a lit wedge in the lower panel's shadow, and whatever single points of the
 * upper one's rays find. */
static void make_tjunction(struct mesh_builder *b, const double *values)
{
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "panels", mesh_builder_material(b, "panels", clay, 0.9f, true));
    for (int k = 0; k < 2; k++) {
        double z = k ? 0.5 : -0.5, y = k ? 0.5 : 1, gap = k ? values[0] : 0;
        struct dvec3 a = {0.07, y, z - 0.37}, c = {-0.05, y + 0.01, z + 0.41};
        struct dvec3 middle = dvec3_add(dvec3_scale(dvec3_add(a, c), 0.5), dvec3(gap, 0, 0));
        mesh_builder_flat_quad(b, dvec3(-1, y, z - 0.4), dvec3(-1, y, z + 0.4), c, a);
        mesh_builder_flat_triangle(b, a, middle, dvec3(1, y, z - 0.4));
        mesh_builder_flat_triangle(b, dvec3(1, y, z - 0.4), middle, dvec3(1, y, z + 0.4));
        mesh_builder_flat_triangle(b, middle, c, dvec3(1, y, z + 0.4));
    }
    mesh_builder_end(b);
    mesh_builder_directional_light(b, dvec3_normalize(dvec3(-0.3, -1, -0.2)), 3);
    mesh_builder_camera(b, dvec3(0.2, 2.6, 3.6), dvec3(-0.1, 0.2, -0.1), 0.7);
}

static const struct builtin_param tjunction_params[] = {
    {"gap", "how far the lower panel's extra vertex lies off the edge", 0, 0.1, 0.02, false},
    {NULL},
};

const struct builtin_scene builtin_hard_tjunction = {
    {"hard-07-tjunction", "Vertices on other triangles' edges: the light that leaks through is right.", tjunction_params},
    make_tjunction};

/* A blade of grass: three triangles, bent. */
static void add_blade(struct mesh_builder *b, struct dvec3 foot, double height, double angle, double width)
{
    struct dvec3 across = {width * cos(angle), 0, width * sin(angle)},
                 lean = {-0.3 * height * sin(angle), 0, 0.3 * height * cos(angle)};
    struct dvec3 middle = dvec3_add(foot, dvec3_add(dvec3(0, 0.6 * height, 0), dvec3_scale(lean, 0.4)));
    struct dvec3 tip = dvec3_add(foot, dvec3_add(dvec3(0, height, 0), lean));
    mesh_builder_flat_quad(b, foot, dvec3_add(foot, across), dvec3_add(middle, across), middle);
    mesh_builder_flat_triangle(b, middle, dvec3_add(middle, across), tip);
}

/* What is to be seen: grass, and wires strung over the floor, 0.05 pixels wide at 1280 x 720; for a slowly moving light or camera.
 * Right answer: at one ray a pixel, scattered dark points that come and go; at 32 samples a faint, steady veil. What a system does beyond the
 * reference's own flicker is its error. */
static void make_thin(struct mesh_builder *b, const double *values)
{
    const double width = 0.05 * 0.0045;
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "grass", mesh_builder_material(b, "grass", (const float[]){0.2f, 0.45f, 0.15f}, 0.9f, true));
    for (uint32_t i = 0; i < (uint32_t)values[0]; i++)
        add_blade(b, dvec3(-1.6 + 1.6 * hash_unit(4 * i), 0, -0.9 + 1.8 * hash_unit(4 * i + 1)), 0.3 + 0.4 * hash_unit(4 * i + 2),
                  2 * PI * hash_unit(4 * i + 3), width);
    mesh_builder_end(b);
    mesh_builder_begin(b, "wires", mesh_builder_material(b, "wires", slate, 0.5f, false));
    for (int i = 0; i < 12; i++) {
        const struct dvec3 ends[2] = {{0.3, 0.3 + 0.05 * i, -0.9 + 0.15 * i}, {1.7, 0.45 + 0.03 * i, -0.8 + 0.14 * i}};
        const double radii[2] = {width / 2, width / 2};
        mesh_builder_tube(b, ends, radii, 2, 4, true);
    }
    mesh_builder_end(b);
    mesh_builder_directional_light(b, dvec3_normalize(dvec3(-0.4, -1, -0.5)), 3);
    mesh_builder_camera(b, dvec3(0, 2.2, 3.6), dvec3(0, 0.1, 0), 0.7);
}

static const struct builtin_param thin_params[] = {
    {"blades", "of grass", 1, 100000, 4000, true},
    {NULL},
};

const struct builtin_scene builtin_hard_thin = {{"hard-09-thin", "Grass and wire a twentieth of a pixel wide.", thin_params},
                                                make_thin};

/* A flat square of two triangles at height y, seen from above or, turned over, from below. */
static void add_square(struct mesh_builder *b, double x, double z, double side, double y, bool turned)
{
    struct dvec3 p = {x, y, z}, q = {x, y, z + side}, r = {x + side, y, z + side}, s = {x + side, y, z};
    if (turned)
        mesh_builder_flat_quad(b, p, s, r, q);
    else
        mesh_builder_flat_quad(b, p, q, r, s);
}

/* What is to be seen: squares that lie in one another, in the same plane: the same one twice, the same one turned over, two that overlap
 * by half, one within another; and the same four again further down.
 * Right answer: the shadows of the squares as if each point were covered once; no square shades its twin, for they are coplanar, from either
 * side; the upper row's shadows fall on the lower row. */
static void make_duplicate(struct mesh_builder *b, const double *values)
{
    (void)values;
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "squares", mesh_builder_material(b, "squares", clay, 0.9f, true));
    for (int k = 0; k < 2; k++) {
        double y = k ? 0.25 : 0.625, z = k ? 0 : -0.25;
        add_square(b, -1.5, z, 0.5, y, false);
        add_square(b, -1.5, z, 0.5, y, false);
        add_square(b, -0.75, z, 0.5, y, false);
        add_square(b, -0.75, z, 0.5, y, true);
        add_square(b, 0, z, 0.5, y, false);
        add_square(b, 0.25, z + 0.125, 0.5, y, true);
        add_square(b, 1, z, 0.5, y, true);
        add_square(b, 1.125, z + 0.125, 0.25, y, false);
    }
    mesh_builder_end(b);
    mesh_builder_point_light(b, dvec3(0.5, 3.25, 1.125), 120);
    mesh_builder_camera(b, dvec3(0, 2.8, 3.4), dvec3(0, 0.1, 0), 0.75);
}

const struct builtin_scene builtin_hard_duplicate = {
    {"hard-10-duplicate", "Duplicate and overlapping triangles, in either winding.", NULL}, make_duplicate};
