/* Two nested geodesic balls of thin wires, after the kind "ball" of the coverage shadow map paper (Li et al. 2017, table 2:
 * 39,936 triangles): wires one over the other at every angle, most of them thinner than a texel. */
#include "builtin/scenes.h"

#define OUTER_RADIUS 1.0
#define INNER_RADIUS 0.62
#define WIRE_SIDES   4
#define JOINT_SIZE   1.7 /* radius, in wires' radii */

/* The icosahedron's 12 corners: (0, +-1, +-g) and its cyclic shifts, and its faces, outward. */
#define G 1.6180339887498949
static const struct dvec3 corners[12] = {
    {-1, G, 0},  {1, G, 0},  {-1, -G, 0}, {1, -G, 0}, {0, -1, G},  {0, 1, G},
    {0, -1, -G}, {0, 1, -G}, {G, 0, -1},  {G, 0, 1},  {-G, 0, -1}, {-G, 0, 1},
};
static const unsigned char faces[20][3] = {
    {0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
    {3, 9, 4},  {3, 4, 2}, {3, 2, 6}, {3, 6, 8},  {3, 8, 9},   {4, 9, 5}, {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1},
};

struct ball {
    struct mesh_builder *b;
    struct dvec3 center;
    double radius, wire; /* of the ball and of its wires */
    unsigned frequency;  /* wires along an icosahedron's edge */
};

/* Node (i, j) of a face: i steps towards its second corner, j towards its third. */
static struct dvec3 node(const struct ball *ball, unsigned face, unsigned i, unsigned j)
{
    const unsigned char *f = faces[face];
    struct dvec3 p = dvec3_scale(corners[f[0]], ball->frequency - i - j);
    p = dvec3_mad(p, corners[f[1]], i);
    p = dvec3_mad(p, corners[f[2]], j);
    return dvec3_mad(ball->center, dvec3_normalize(p), ball->radius);
}

static void wire(const struct ball *ball, struct dvec3 from, struct dvec3 to)
{
    const struct dvec3 points[2] = {from, to};
    const double radii[2] = {ball->wire, ball->wire};
    mesh_builder_tube(ball->b, points, radii, 2, WIRE_SIDES, false);
}

/* An octahedron, a little thicker than the wires that end in it. */
static void joint(const struct ball *ball, struct dvec3 center)
{
    struct dvec3 y = dvec3_normalize(dvec3_sub(center, ball->center));
    struct dvec3 x = dvec3_normalize(dvec3_cross(fabs(y.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0), y));
    const struct dvec3 axes[3] = {x, y, dvec3_cross(x, y)};
    double r = JOINT_SIZE * ball->wire;
    mesh_builder_ellipsoid(ball->b, center, axes, (const double[]){r, r, r}, 2, 4);
}

/* Inside a face all three directions; on an edge that two faces share, from the face that comes along it forwards. */
static void face_wires(const struct ball *ball, unsigned face)
{
    const unsigned char *f = faces[face];
    unsigned n = ball->frequency;
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; i + j < n; j++) {
            struct dvec3 here = node(ball, face, i, j), right = node(ball, face, i + 1, j), up = node(ball, face, i, j + 1);
            if (j > 0 || f[0] < f[1])
                wire(ball, here, right);
            if (i > 0 || f[2] < f[0])
                wire(ball, here, up);
            if (i + j + 1 < n || f[1] < f[2])
                wire(ball, right, up);
            if (i > 0 && j > 0)
                joint(ball, here);
            if (i == 0 && j > 0 && f[2] < f[0])
                joint(ball, here);
            if (j == 0 && i > 0 && f[0] < f[1])
                joint(ball, here);
            if (i + j + 1 == n && j > 0 && f[1] < f[2])
                joint(ball, right);
        }
}

static void make_shell(const struct ball *ball, const char *name, const float rgb[3])
{
    mesh_builder_begin(ball->b, name, mesh_builder_material(ball->b, name, rgb, 0.5f, false));
    for (unsigned face = 0; face < 20; face++)
        face_wires(ball, face);
    for (unsigned i = 0; i < 12; i++)
        joint(ball, dvec3_mad(ball->center, dvec3_normalize(corners[i]), ball->radius));
    mesh_builder_end(ball->b);
}

/* Lowest node of the outer ball, below its centre: the middle of the icosahedron's lowest edge, or beside it. */
static double lowest_node(unsigned frequency)
{
    return frequency % 2 == 0 ? OUTER_RADIUS : OUTER_RADIUS * G * frequency / sqrt(1 + G * G * frequency * frequency);
}

static void make_ball(struct mesh_builder *b, const double *values)
{
    unsigned frequency = (unsigned)values[0];
    double wire_radius = values[1];
    struct dvec3 center = {0, lowest_node(frequency) + JOINT_SIZE * wire_radius, 0};
    struct ball outer = {b, center, OUTER_RADIUS, wire_radius, frequency};
    struct ball inner = {b, center, INNER_RADIUS, wire_radius, (frequency + 1) / 2};
    make_shell(&outer, "outer ball", (const float[]){0.72f, 0.45f, 0.20f});
    make_shell(&inner, "inner ball", (const float[]){0.25f, 0.45f, 0.55f});
    mesh_builder_stage(b);
}

/* A ball of frequency f has 30 f^2 wires and 10 f^2 + 2 joints of 8 triangles each: 40,034 with the ground for 10 and 5. */
static const struct builtin_param params[] = {
    {"frequency", "wires along an edge of the outer ball's icosahedron; the inner ball has half as many", 1, 40, 10, true},
    {"wire", "radius of the wires, scene units", 0.0005, 0.015, 0.006, false},
    {NULL},
};

const struct builtin_scene builtin_ball = {{"ball", "Two nested geodesic balls of thin wires.", params}, make_ball};
