/* Hard cases about samples: many triangles for one texel, edges exactly through pixel centres. */
#include "builtin/scenes.h"

#define PI 3.14159265358979323846

static const float grey[3] = {0.7f, 0.7f, 0.7f};
static const float clay[3] = {0.75f, 0.4f, 0.25f};

/* What is to be seen: a small regular polygon cut into slices like a cake, each slice at a height of its own and the light
 * straight above, seen from so near that only its shadow is in the picture. Two far posts make the light's map 4 units wide, so
 * that the cake, 0.0012 across, fits in one texel of a 1024 map (or in the few around a texel's corner).
 * Right answer: the shadow is the whole polygon, without seams between the slices. A system that keeps k triangles a texel loses
 * the others' slices. */
static void make_depth(struct mesh_builder *b, const double *values)
{
    const struct dvec3 middle = {0.0015, 0, 0.0015};
    const double radius = 0.0006;
    unsigned slices = (unsigned)values[0];
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "posts", mesh_builder_material(b, "posts", grey, 0.9f, false));
    mesh_builder_box(b, dvec3(-1.95, 0, -1.95), dvec3(0.1, 1, 0.1), 0);
    mesh_builder_box(b, dvec3(1.95, 0, 1.95), dvec3(0.1, 1, 0.1), 0);
    mesh_builder_end(b);
    mesh_builder_begin(b, "slices", mesh_builder_material(b, "slices", clay, 0.9f, false));
    for (unsigned k = 0; k < slices; k++) {
        double from = 2 * PI * k / slices, to = 2 * PI * ((k + 1) % slices) / slices;
        /* Neighbours are not next to one another in depth. */
        double y = 0.5 + 0.5 * hash_unit(k);
        mesh_builder_flat_triangle(b, dvec3(middle.x, y, middle.z),
                                   dvec3(middle.x + radius * sin(from), y, middle.z + radius * cos(from)),
                                   dvec3(middle.x + radius * sin(to), y, middle.z + radius * cos(to)));
    }
    mesh_builder_end(b);
    mesh_builder_directional_light(b, dvec3(0, -1, 0), 3);
    mesh_builder_camera(b, dvec3(middle.x, 0.008, 0.006), middle, 0.35);
}

static const struct builtin_param depth_params[] = {
    {"triangles", "slices, all in one texel of a 1024 map", 5, 4096, 64, true},
    {NULL},
};

const struct builtin_scene builtin_hard_depth = {
    {"hard-08-depth", "Many triangles at different depths in one texel.", depth_params}, make_depth};

/* Added to every x of a caster at odd height y, so that x + y/4 is a pixel centre's. */
static double grid_shift(double y) { return 0.5 - (y / 4 - floor(y / 4)); }

/* A flat triangle at odd height y: whole-number corners (x, z), counter-clockwise seen from above. */
static void grid_triangle(struct mesh_builder *b, double y, const int corners[6])
{
    double x = grid_shift(y);
    mesh_builder_flat_triangle(b, dvec3(x + corners[0], y, corners[1]), dvec3(x + corners[2], y, corners[3]),
                               dvec3(x + corners[4], y, corners[5]));
}

/* Two triangles; the shared edge runs from (x0, z1) to (x1, z0). */
static void grid_square(struct mesh_builder *b, double y, int x0, int z0, int x1, int z1)
{
    grid_triangle(b, y, (const int[]){x0, z0, x0, z1, x1, z0});
    grid_triangle(b, y, (const int[]){x1, z0, x0, z1, x1, z1});
}

/* A closed fan of eight triangles about (x, z): its middle's shadow is a pixel centre. */
static void grid_fan(struct mesh_builder *b, double y, int x, int z)
{
    static const int ring[8][2] = {{-4, -4}, {-4, 0}, {-4, 4}, {0, 4}, {4, 4}, {4, 0}, {4, -4}, {0, -4}};
    for (int k = 0; k < 8; k++) {
        const int *p = ring[k], *q = ring[(k + 1) % 8];
        grid_triangle(b, y, (const int[]){x, z, x + p[0], z + p[1], x + q[0], z + q[1]});
    }
}

static void add_grid_casters(struct mesh_builder *b)
{
    grid_square(b, 15, -28, -28, -22, -22);
    /* Two squares at different heights whose shadows share an edge: x from -7.5 to -3.5 to 0.5, z from -20.5 to -14.5. */
    grid_square(b, 15, -11, -28, -7, -22);
    grid_square(b, 13, -7, -27, -3, -21);
    grid_triangle(b, 15, (const int[]){12, -28, 12, -22, 18, -28});
    grid_triangle(b, 15, (const int[]){-28, -8, -28, -2, -22, -5});
    grid_fan(b, 17, -8, -2);
    /* Single units, corner to corner. */
    for (int k = 0; k < 5; k++)
        grid_square(b, 11, 12 + k, -4 + k, 13 + k, -3 + k);
    /* An upright sheet along the light's way: its shadow has no area. And one across it that stands on the floor. */
    mesh_builder_flat_quad(b, dvec3(-28, 0, 12), dvec3(-25, 0, 18), dvec3(-25, 9, 18), dvec3(-28, 9, 12));
    mesh_builder_flat_quad(b, dvec3(-3.75, 0, 14), dvec3(2.25, 0, 14), dvec3(2.25, 9, 14), dvec3(-3.75, 9, 14));
}

/* What is to be seen, at 64 x 64 pixels: flat casters over a floor, from straight above, each beside its shadow.
 *
 * Why shadow edges run exactly through pixel centres: the orthographic camera spans 64 x 64 units about the origin, so at 64 x
 * 64 pixels the centre of pixel (i, j) lies at x = i - 31.5, z = j - 31.5, computed without rounding. The light's direction is s
 * * (1, -4, 2) with s = 1 / sqrt(21) rounded once: multiplying by 2 and 4 is exact, so the three numbers stand in the ratio 1 :
 * -4 : 2 exactly (and still do after a division by a common length). A corner (x, y, z) therefore throws its shadow on y = 0 at
 * (x + y/4, z + y/2) exactly. The flat casters have whole z, odd y and an x that makes x + y/4 a whole number and a half: every
 * corner of their shadows is a pixel centre, and the shadows' edges along the axes, at 45 degrees and of slope 1/2 pass through
 * the centres of all, or every second, of the pixels they cross. The casters' own edges meet no pixel centre, for their x has a
 * quarter in it: what the camera sees is beyond doubt. Nor does the floor's diagonal, z = 5/6 x.
 *
 * Right answer: the half-open rule of the truth at every such pixel: along an edge that two casters' triangles share, in the
 * mesh or in the shadow alone, every pixel is dark; a rectangle's shadow of n x m units has exactly n * m dark pixels; each
 * single unit exactly one; the sheet along the light none. At other sizes it is a harmless scene. */
static void make_grid(struct mesh_builder *b, const double *values)
{
    (void)values;
    mesh_builder_ground(b, 96, 80, grey);
    mesh_builder_begin(b, "casters", mesh_builder_material(b, "casters", clay, 0.9f, true));
    add_grid_casters(b);
    mesh_builder_end(b);
    double s = 1 / sqrt(21.0);
    mesh_builder_directional_light(b, dvec3(s, -4 * s, 2 * s), 3);
    mesh_builder_camera_above(b, 32, 32);
}

const struct builtin_scene builtin_hard_grid = {
    {"hard-21-grid", "Shadow edges exactly through pixel centres; render it at 64x64.", NULL}, make_grid};
