/* Hard cases about where the light stands. */
#include "builtin/scenes.h"

#define PI 3.14159265358979323846

static const float grey[3] = {0.7f, 0.7f, 0.7f};
static const float clay[3] = {0.75f, 0.4f, 0.25f};
static const float slate[3] = {0.3f, 0.5f, 0.65f};

/* What is to be seen: a table whose top lies at y = 0.5 exactly, as high as the point light; an upright sheet in the plane z = 0, in which
 * the light lies too; a post.
 * Right answer: on the top N.L = 0: no receiver, dark. The sheet's shadow has no area: it darkens nothing. The post casts as usual. */
static void make_plane(struct mesh_builder *b, const double *values)
{
    (void)values;
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "table", mesh_builder_material(b, "table", slate, 0.9f, false));
    mesh_builder_box(b, dvec3(-1, 0, 0.875), dvec3(0.75, 0.5, 0.5), 0);
    mesh_builder_box(b, dvec3(-0.5, 0, -0.75), dvec3(0.125, 0.375, 0.125), 0);
    mesh_builder_end(b);
    mesh_builder_begin(b, "sheet", mesh_builder_material(b, "sheet", clay, 0.9f, true));
    mesh_builder_flat_quad(b, dvec3(-0.75, 0, 0), dvec3(0.25, 0, 0), dvec3(0.25, 0.75, 0), dvec3(-0.75, 0.75, 0));
    mesh_builder_end(b);
    mesh_builder_point_light(b, dvec3(1.5, 0.5, 0), 30);
    mesh_builder_camera(b, dvec3(0.4, 2.4, 3.2), dvec3(-0.3, 0.1, 0), 0.7);
}

const struct builtin_scene builtin_hard_plane = {
    {"hard-02-plane", "The light exactly in a receiver's plane and in a caster's.", NULL}, make_plane};

/* What is to be seen: a lantern, a point light inside a cage of four bars on a plinth; a long triangle that runs past the light from far in
 * front of it to far behind, above and below it.
 * Right answer: as ray tracing: the part of the triangle between light and floor shadows the floor, the rest nothing; the bars' four
 * shadows run outwards from the lantern. A projection that divides by a depth without clipping first gets wild shapes. */
static void make_behind(struct mesh_builder *b, const double *values)
{
    (void)values;
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "cage", mesh_builder_material(b, "cage", slate, 0.9f, true));
    for (int i = 0; i < 4; i++)
        mesh_builder_box(b, dvec3(i & 1 ? 0.2 : -0.2, 0.3, i & 2 ? 0.2 : -0.2), dvec3(0.04, 0.6, 0.04), 0);
    mesh_builder_box(b, dvec3(0, 0.2, 0), dvec3(0.5, 0.1, 0.5), 0);
    mesh_builder_end(b);
    mesh_builder_begin(b, "sail", mesh_builder_material(b, "sail", clay, 0.9f, true));
    mesh_builder_flat_triangle(b, dvec3(-2.5, 0.05, -0.9), dvec3(2.5, 1.9, -0.7), dvec3(-0.3, 0.4, 1.9));
    mesh_builder_end(b);
    mesh_builder_point_light(b, dvec3(0.01, 0.62, 0.03), 20);
    mesh_builder_camera(b, dvec3(1.5, 3.2, 4.2), dvec3(0, 0.2, 0), 0.8);
}

const struct builtin_scene builtin_hard_behind = {
    {"hard-12-behind", "Triangles that cross the light's plane and surround the light.", NULL}, make_behind};

/* What is to be seen: a ball over the floor; the point light hangs `gap` under a board, or (inside=1) in the middle of the ball.
 * Right answer: the board is lit by a spot of light about as wide as the gap, and casts nothing downwards; with inside=1 the closed ball
 * keeps all the light and everything outside is dark. */
static void make_near(struct mesh_builder *b, const double *values)
{
    const struct dvec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const struct dvec3 ball = {0.3, 0.5, 0};
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "ball", mesh_builder_material(b, "ball", clay, 0.9f, false));
    mesh_builder_ellipsoid(b, ball, axes, (const double[]){0.25, 0.25, 0.25}, 16, 32);
    mesh_builder_end(b);
    mesh_builder_begin(b, "board", mesh_builder_material(b, "board", slate, 0.9f, false));
    mesh_builder_box(b, dvec3(-0.5, 1, 0), dvec3(1, 0.05, 1), 0.2);
    mesh_builder_end(b);
    mesh_builder_point_light(b, values[1] > 0 ? ball : dvec3(-0.5, 1 - values[0], 0), 15);
    mesh_builder_camera(b, dvec3(0.5, 1.6, 3.4), dvec3(0, 0.4, 0), 0.7);
}

static const struct builtin_param near_params[] = {
    {"gap", "distance of the light from the board above it", 1e-6, 0.1, 1e-3, false},
    {"inside", "1: the light is inside the closed ball", 0, 1, 0, true},
    {NULL},
};

const struct builtin_scene builtin_hard_near = {
    {"hard-13-near", "A light very close to a surface, or inside a closed mesh.", near_params}, make_near};

/* What is to be seen: blocks lit by a point light `distance` away, or (directional=1) by the directional light it tends to.
 * Right answer: at 1e7 the two pictures' shadows agree but for about one pixel in a thousand along their edges. */
static void make_far(struct mesh_builder *b, const double *values)
{
    const struct dvec3 to_light = dvec3_normalize(dvec3(0.5, 0.75, 0.4375));
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "blocks", mesh_builder_material(b, "blocks", clay, 0.9f, false));
    for (int i = 0; i < 5; i++)
        mesh_builder_box(b, dvec3(-1.5 + 0.75 * i, 0, 0.3 * (i % 2)), dvec3(0.3, 0.2 + 0.2 * i, 0.3), 0.4 * i);
    mesh_builder_end(b);
    if (values[1] > 0)
        mesh_builder_directional_light(b, dvec3_neg(to_light), 3);
    else
        mesh_builder_point_light(b, dvec3_scale(to_light, values[0]), (float)(3 * values[0] * values[0]));
    mesh_builder_camera(b, dvec3(0, 2.5, 4.5), dvec3(0, 0.3, 0), 0.7);
}

static const struct builtin_param far_params[] = {
    {"distance", "of the light", 10, 1e7, 1e7, false},
    {"directional", "1: the directional light that the point light tends to", 0, 1, 0, true},
    {NULL},
};

const struct builtin_scene builtin_hard_far = {
    {"hard-14-far", "A point light so far away that it might be directional.", far_params}, make_far};

/* What is to be seen: a row of posts from a hand's breadth before the eye to a thousand units away, each as large as it is far; a bead right
 * under the light, and the floor far below it.
 * Right answer: every post has its shadow, at depths in the ratio of 1 to 1e6 for eye and light; the bead's, very large, covers part of the
 * floor. */
static void make_ratio(struct mesh_builder *b, const double *values)
{
    (void)values;
    const struct dvec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const struct dvec3 light = {200, 400, 100};
    mesh_builder_ground(b, 4000, 4000, grey);
    mesh_builder_begin(b, "posts", mesh_builder_material(b, "posts", clay, 0.9f, false));
    for (int i = 0; i < 13; i++) {
        double far = 0.004 * pow(2.6, i);
        mesh_builder_box(b, dvec3((i % 2 ? 0.3 : -0.35) * far, 0, -far), dvec3(0.1 * far, 0.25 * far, 0.1 * far), 0.3 * i);
    }
    mesh_builder_end(b);
    mesh_builder_begin(b, "bead", mesh_builder_material(b, "bead", slate, 0.9f, false));
    mesh_builder_ellipsoid(b, dvec3_mad(light, dvec3(-0.30, -0.85, -0.60), 0.0006), axes, (const double[]){5e-5, 5e-5, 5e-5}, 8,
                           16);
    mesh_builder_end(b);
    mesh_builder_point_light(b, light, 6e5f);
    mesh_builder_camera(b, dvec3(0, 0.0016, 0.0016), dvec3(0, 0.0012, -0.002), 0.8);
    if (!b->failed)
        b->cameras.data[0].near = 0.001;
}

const struct builtin_scene builtin_hard_ratio = {
    {"hard-17-ratio", "Depths in the ratio of one to a million, for the eye and for the light.", NULL}, make_ratio};

/* A bar from `p` to `q`. */
static void add_bar(struct mesh_builder *b, struct dvec3 p, struct dvec3 q)
{
    const struct dvec3 ends[2] = {p, q};
    const double radii[2] = {0.03, 0.03};
    mesh_builder_tube(b, ends, radii, 2, 8, true);
}

/* What is to be seen: a room's corner with a point light in it, among bars whose shadows run over the edges and corners of any cube that
 * stands straight around the light, turned with the light in the middle by `turn` degrees.
 * Right answer: shadows run on over floor and walls without a step or gap. turn= moves the seams over the scene and changes nothing but the
 * bars' own places. */
static void make_seams(struct mesh_builder *b, const double *values)
{
    const struct dvec3 light = {0, 1, 0};
    double turn = values[0] * PI / 180, c = cos(turn), s = sin(turn);
    mesh_builder_ground(b, 6, 6, grey);
    mesh_builder_begin(b, "walls", mesh_builder_material(b, "walls", grey, 0.9f, true));
    mesh_builder_flat_quad(b, dvec3(-2, 0, -2), dvec3(2, 0, -2), dvec3(2, 2.5, -2), dvec3(-2, 2.5, -2));
    mesh_builder_flat_quad(b, dvec3(-2, 0, 2), dvec3(-2, 0, -2), dvec3(-2, 2.5, -2), dvec3(-2, 2.5, 2));
    mesh_builder_end(b);
    mesh_builder_begin(b, "bars", mesh_builder_material(b, "bars", clay, 0.9f, false));
    for (int i = 0; i < 4; i++) {
        double x = i & 1 ? 0.6 : -0.6, z = i & 2 ? 0.6 : -0.6;
        struct dvec3 corner = dvec3(c * x + s * z, 0, c * z - s * x);
        struct dvec3 next = dvec3(c * x - s * z, 0, -c * z - s * x);
        add_bar(b, dvec3_add(corner, dvec3(0, 0.25, 0)), dvec3_add(corner, dvec3(0, 1.75, 0)));
        add_bar(b, dvec3_add(corner, dvec3(0, 0.4, 0)), dvec3_add(dvec3_scale(next, 0.9), dvec3(0, 0.5, 0)));
        add_bar(b, dvec3_add(dvec3_scale(corner, 0.7), dvec3(0, 0.58, 0)),
                dvec3_add(dvec3_scale(corner, 1.2), dvec3(0, 1.35, 0)));
    }
    mesh_builder_end(b);
    mesh_builder_point_light(b, light, 12);
    mesh_builder_camera(b, dvec3(3.4, 3.1, 3.4), dvec3(-0.5, 0.7, -0.5), 0.75);
}

static const struct builtin_param seams_params[] = {
    {"turn", "degrees by which the bars are turned about the light", 0, 90, 0, false},
    {NULL},
};

const struct builtin_scene builtin_hard_seams = {
    {"hard-18-seams", "Shadows over the seams and corners of a point light's cube.", seams_params}, make_seams};
