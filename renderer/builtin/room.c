/* A lamp in the ceiling of a large room, and small things on its floor: the light's view is wide, the camera's narrow. After the test scene
 * of Fernando et al. 2001, "Adaptive Shadow Maps": 31,000 triangles in three objects, a light of 122 degrees far from them. Here an
 * animal of 20,000 triangles whose surface is rough, a machine of 6,000, a sculpture of thin wires of 5,000. The walls are planar meshes
 * with everything on one side, so they cast nothing and widen no fit. */
#include "builtin/scenes.h"
#include "builtin/sweep.h"

#include <stdio.h>

#define PI     3.14159265358979323846
#define SIDE   20.0
#define HEIGHT 8.0
/* Of each object. */
#define TALL   0.5

/* Middle of the bottom of each. */
static const struct dvec3 animal_place = {-7.8, 0, -6.8}, machine_place = {8.3, 0, -5.8}, sculpture_place = {2.4, 0, 8.6};

static void add_wall(struct mesh_builder *b, uint32_t material, const char *name, struct dvec3 p, struct dvec3 q, struct dvec3 r,
                     struct dvec3 s)
{
    mesh_builder_begin(b, name, material);
    mesh_builder_flat_quad(b, p, q, r, s);
    mesh_builder_end(b);
}

/* Counter-clockwise seen from inside. */
static void add_walls(struct mesh_builder *b)
{
    const double h = SIDE / 2, t = HEIGHT;
    uint32_t floor = mesh_builder_material(b, "floor", (const float[]){0.74f, 0.71f, 0.66f}, 0.9f, false);
    uint32_t wall = mesh_builder_material(b, "wall", (const float[]){0.66f, 0.70f, 0.72f}, 0.95f, false);
    add_wall(b, floor, "floor", dvec3(-h, 0, h), dvec3(h, 0, h), dvec3(h, 0, -h), dvec3(-h, 0, -h));
    add_wall(b, wall, "ceiling", dvec3(-h, t, -h), dvec3(h, t, -h), dvec3(h, t, h), dvec3(-h, t, h));
    add_wall(b, wall, "north wall", dvec3(-h, 0, -h), dvec3(h, 0, -h), dvec3(h, t, -h), dvec3(-h, t, -h));
    add_wall(b, wall, "south wall", dvec3(h, 0, h), dvec3(-h, 0, h), dvec3(-h, t, h), dvec3(h, t, h));
    add_wall(b, wall, "west wall", dvec3(-h, 0, h), dvec3(-h, 0, -h), dvec3(-h, t, -h), dvec3(-h, t, h));
    add_wall(b, wall, "east wall", dvec3(h, 0, -h), dvec3(h, 0, h), dvec3(h, t, h), dvec3(h, t, -h));
}

/* Scales the mesh being made to its height, and puts it in its place. */
static void put(struct mesh_builder *b, struct dvec3 place)
{
    uint32_t count = mesh_builder_vertices(b);
    struct builder_float3 *p = b->positions.data + (b->positions.count - count);
    double low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        low = fmin(low, p[i].v[1]);
        high = fmax(high, p[i].v[1]);
    }
    double scale = count ? TALL / (high - low) : 1;
    for (uint32_t i = 0; i < count; i++) {
        p[i].v[0] = (float)(place.x + scale * p[i].v[0]);
        p[i].v[1] = (float)(place.y + scale * (p[i].v[1] - low));
        p[i].v[2] = (float)(place.z + scale * p[i].v[2]);
    }
}

static double fur(struct mesh_builder *b, const struct sweep_place *p)
{
    double rough = 0.5 * noise3(dvec3_scale(p->position, 6)) + 0.3 * noise3(dvec3_scale(p->position, 19)) +
                   0.2 * noise3(dvec3_scale(p->position, 47));
    mesh_builder_color(b, 0.52 + 0.18 * rough, 0.40 + 0.14 * rough, 0.30 + 0.1 * rough);
    return p->radius * 0.22 * rough;
}

static const struct sweep_knot trunk[] = {
    {{-0.62, 0.42, 0}, 0.10, {0, 1, 0}},   {{-0.42, 0.40, 0.02}, 0.30, {0, 1, 0}},   {{-0.05, 0.42, 0}, 0.37, {0, 1, 0}},
    {{0.26, 0.62, 0}, 0.25, {-1, 0.5, 0}}, {{0.46, 0.92, 0.02}, 0.22, {-0.5, 1, 0}}, {{0.72, 0.86, 0.06}, 0.10, {0, 1, 0}},
};
static const struct sweep_knot ears[2][3] = {
    {{{0.42, 1.04, 0.10}, 0.07, {-1, 0, 0}}, {{0.34, 1.34, 0.18}, 0.085, {-1, 0, 0}}, {{0.22, 1.62, 0.22}, 0.02, {-1, 0, 0}}},
    {{{0.42, 1.04, -0.08}, 0.07, {-1, 0, 0}}, {{0.40, 1.36, -0.14}, 0.085, {-1, 0, 0}}, {{0.42, 1.66, -0.22}, 0.02, {-1, 0, 0}}},
};
static const struct sweep_knot feet[4][3] = {
    {{{0.20, 0.45, 0.20}, 0.10, {1, 0, 0}}, {{0.32, 0.20, 0.24}, 0.08, {1, 0, 0}}, {{0.46, 0.06, 0.25}, 0.05, {0, 1, 0}}},
    {{{0.20, 0.45, -0.20}, 0.10, {1, 0, 0}}, {{0.32, 0.20, -0.24}, 0.08, {1, 0, 0}}, {{0.46, 0.06, -0.25}, 0.05, {0, 1, 0}}},
    {{{-0.34, 0.40, 0.26}, 0.20, {1, 0, 0}}, {{-0.28, 0.18, 0.32}, 0.12, {1, 0, 0}}, {{-0.02, 0.06, 0.33}, 0.06, {0, 1, 0}}},
    {{{-0.34, 0.40, -0.26}, 0.20, {1, 0, 0}}, {{-0.28, 0.18, -0.32}, 0.12, {1, 0, 0}}, {{-0.02, 0.06, -0.33}, 0.06, {0, 1, 0}}},
};

static void add_part(struct mesh_builder *b, const struct sweep_knot *knots, unsigned count, uint32_t triangles, double slimness)
{
    unsigned rings, sides;
    sweep_grid(triangles, slimness, &rings, &sides);
    sweep_add(b, &(struct sweep){knots, count, fur}, rings, sides);
}

static void add_animal(struct mesh_builder *b)
{
    mesh_builder_begin_colored(b, "animal", mesh_builder_material(b, "fur", (const float[]){1, 1, 1}, 0.8f, false));
    for (int i = 0; i < 4; i++)
        add_part(b, feet[i], 3, 1200, 1.5);
    for (int i = 0; i < 2; i++)
        add_part(b, ears[i], 3, 1800, 2);
    add_part(b, trunk, 6, 20000 - mesh_builder_triangles(b), 1.4);
    mesh_builder_smooth(b, 0);
    put(b, animal_place);
    mesh_builder_end(b);
}

static void add_pipe(struct mesh_builder *b, struct dvec3 from, struct dvec3 to, double radius, unsigned sides)
{
    const struct dvec3 points[2] = {from, to};
    const double radii[2] = {radius, radius};
    mesh_builder_tube(b, points, radii, 2, sides, true);
}

static void add_ball(struct mesh_builder *b, struct dvec3 center, double radius, unsigned rings, unsigned sides)
{
    const struct dvec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double radii[3] = {radius, radius, radius};
    mesh_builder_ellipsoid(b, center, axes, radii, rings, sides);
}

/* An arm or a leg: two pipes and three joints. */
static void add_limb(struct mesh_builder *b, struct dvec3 top, struct dvec3 middle, struct dvec3 end, double radius)
{
    add_pipe(b, top, middle, radius, 16);
    add_pipe(b, middle, end, 0.8 * radius, 16);
    add_ball(b, top, 1.5 * radius, 12, 20);
    add_ball(b, middle, 1.4 * radius, 12, 20);
    add_ball(b, end, 1.5 * radius, 8, 16);
}

static void add_machine(struct mesh_builder *b)
{
    mesh_builder_begin(b, "machine", mesh_builder_material(b, "enamel", (const float[]){0.30f, 0.45f, 0.58f}, 0.4f, false));
    mesh_builder_box(b, dvec3(0, 0.45, 0), dvec3(0.42, 0.50, 0.30), 0);
    mesh_builder_box(b, dvec3(0, 1.02, 0.02), dvec3(0.28, 0.22, 0.24), 0.2);
    add_pipe(b, dvec3(0, 0.93, 0), dvec3(0, 1.05, 0.01), 0.06, 16);
    add_limb(b, dvec3(0.25, 0.88, 0), dvec3(0.40, 0.66, 0.08), dvec3(0.34, 0.46, 0.26), 0.035);
    add_limb(b, dvec3(-0.25, 0.88, 0), dvec3(-0.44, 0.98, 0.10), dvec3(-0.46, 1.20, 0.16), 0.035);
    add_limb(b, dvec3(0.13, 0.45, 0), dvec3(0.16, 0.24, 0.06), dvec3(0.15, 0.06, 0), 0.045);
    add_limb(b, dvec3(-0.13, 0.45, 0), dvec3(-0.16, 0.24, 0.06), dvec3(-0.15, 0.06, 0), 0.045);
    add_pipe(b, dvec3(0.10, 1.20, 0), dvec3(0.16, 1.44, -0.03), 0.008, 8);
    add_ball(b, dvec3(0.16, 1.44, -0.03), 0.025, 8, 12);
    for (int i = 0; i < 7; i++)
        add_pipe(b, dvec3(-0.15 + 0.05 * i, 0.62, 0.148), dvec3(-0.15 + 0.05 * i, 0.62, 0.19), 0.016, 12);
    unsigned left = 6000 - mesh_builder_triangles(b);
    add_ball(b, dvec3(0, 0.72, 0.13), 0.09, 2 + left / 64, 32);
    put(b, machine_place);
    mesh_builder_end(b);
}

/* A (2, 3) torus knot of wire in a cage of thinner ones. */
static void add_sculpture(struct mesh_builder *b)
{
    enum { POINTS = 141, SIDES = 8, CAGE = 12 };
    struct dvec3 points[POINTS];
    double radii[POINTS];
    mesh_builder_begin(b, "sculpture", mesh_builder_material(b, "bronze", (const float[]){0.62f, 0.42f, 0.20f}, 0.4f, false));
    for (int i = 0; i < POINTS; i++) {
        double t = 2 * PI * i / (POINTS - 1), r = 0.30 + 0.13 * cos(3 * t);
        points[i] = dvec3(r * cos(2 * t), 0.50 + 0.26 * sin(3 * t), r * sin(2 * t));
        radii[i] = 0.022;
    }
    mesh_builder_tube(b, points, radii, POINTS, SIDES, false);
    for (int i = 0; i < CAGE; i++) {
        struct dvec3 arc[33];
        double thin[33], around = PI * i / CAGE;
        for (int k = 0; k < 33; k++) {
            double up = 2 * PI * k / 32;
            arc[k] = dvec3(0.5 * cos(up) * cos(around), 0.5 + 0.5 * sin(up), 0.5 * cos(up) * sin(around));
            thin[k] = 0.004;
        }
        mesh_builder_tube(b, arc, thin, 33, 3, false);
    }
    for (int i = 1; i < 4; i++) {
        struct dvec3 ring[21];
        double thin[21], y = -0.5 + 0.25 * i;
        for (int k = 0; k < 21; k++) {
            double t = 2 * PI * k / 20, r = sqrt(0.25 - y * y);
            ring[k] = dvec3(r * cos(t), 0.5 + y, r * sin(t));
            thin[k] = 0.004;
        }
        mesh_builder_tube(b, ring, thin, 21, 3, false);
    }
    put(b, sculpture_place);
    mesh_builder_end(b);
}

/* `height` scene units are to be seen at the target. */
static void add_camera(struct mesh_builder *b, const char *name, struct dvec3 target, struct dvec3 away, double height)
{
    const double yfov = 0.7;
    mesh_builder_camera(b, dvec3_mad(target, dvec3_normalize(away), height / (2 * tan(yfov / 2))), target, yfov);
    mesh_builder_name_camera(b, name);
}

static void make_room(struct mesh_builder *b, const double *values)
{
    (void)values;
    add_walls(b);
    add_animal(b);
    add_machine(b);
    add_sculpture(b);
    mesh_builder_spot_light(b, dvec3(0, HEIGHT - 0.05, 0), dvec3(0, -1, 0), 60 * PI / 180, 61 * PI / 180, 900);
    mesh_builder_camera(b, dvec3(6.5, 5.2, 9.3), dvec3(-1.2, 0, -2.4), 1.15);
    mesh_builder_name_camera(b, "wide");
    /* From the side: the shadow falls outwards. */
    add_camera(b, "close", dvec3_add(animal_place, dvec3(-0.13, 0.15, -0.12)), dvec3(0.8, 0.65, -0.4), 2 * TALL);
    add_camera(b, "closest", dvec3_add(animal_place, dvec3(-0.19, 0.0, -0.30)), dvec3(0.8, 0.65, -0.4), 0.1);
}

const struct builtin_scene builtin_room = {
    {"room", "A lamp in the ceiling of a large room with small things on its floor.", NULL}, make_room};
