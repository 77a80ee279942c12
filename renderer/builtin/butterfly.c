/* A butterfly, after the kind "butterfly" of the coverage shadow map paper (Li et al. 2017, table 2: 73,138 triangles): wings
 * without any thickness, slit along their veins so that light comes through lines thinner than a texel, and legs, antennae and
 * veins as thin as hairs. */
#include "builtin/scenes.h"

#define PI         3.14159265358979323846
#define SLIT       0.0035 /* half width of a slit; a texel of a 1024 map that holds the model is about 0.002 */
#define WING_START 0.05   /* of a panel, of its vein's length */

/* A vein: its way from the wing's root (radians, 0 = straight sideways, positive = forwards) and its length. */
struct vein {
    double angle, length;
};

static const struct vein fore_veins[] = {
    {1.02, 0.86}, {0.90, 0.98}, {0.74, 1.06}, {0.58, 1.05}, {0.41, 0.98}, {0.24, 0.90}, {0.07, 0.83}, {-0.10, 0.76},
};
static const struct vein hind_veins[] = {
    {-0.06, 0.66}, {-0.24, 0.74}, {-0.42, 0.78}, {-0.60, 0.79}, {-0.79, 0.80}, {-0.99, 0.86}, {-1.19, 0.66},
};

struct wing {
    const struct vein *veins;
    unsigned panels;
    double side;       /* +1 or -1 */
    double raised;     /* radians above the horizontal */
    struct dvec3 root; /* in the body's frame: x sideways, y up, z forwards */
    double lift;       /* of the surface along its normal: keeps the hind wing below the fore wing */
};

static const struct wing wings[4] = {
    {fore_veins, 7, 1, 0.48, {0.03, 0.46, 0.06}, 0.012},
    {fore_veins, 7, -1, 0.48, {-0.03, 0.46, 0.06}, 0.012},
    {hind_veins, 6, 1, 0.36, {0.03, 0.45, -0.02}, -0.004},
    {hind_veins, 6, -1, 0.36, {-0.03, 0.45, -0.02}, -0.004},
};

/* The animal is seen from behind, turned a little. */
static struct dvec3 turned(struct dvec3 p)
{
    const double c = -0.9553364891, s = -0.2955202067; /* of pi + 0.3 radians */
    return dvec3(c * p.x + s * p.z, p.y, c * p.z - s * p.x);
}

/* All but the legs also stands with its head up. */
static struct dvec3 pitched(struct dvec3 direction)
{
    const double c = 0.9210609940, s = 0.3894183423; /* of 0.4 radians */
    return dvec3(direction.x, c * direction.y + s * direction.z, c * direction.z - s * direction.y);
}

static struct dvec3 posed(struct dvec3 p)
{
    const struct dvec3 thorax = {0, 0.445, 0.080};
    return turned(dvec3_add(thorax, pitched(dvec3_sub(p, thorax))));
}

/* A wing is a bent sheet over polar coordinates about its root. */
static struct dvec3 wing_point(const struct wing *w, double angle, double distance)
{
    double out = distance * cos(angle), forward = distance * sin(angle);
    double up = w->lift + 0.10 * distance * (1 - distance) + 0.05 * forward * out;
    double c = cos(w->raised), s = sin(w->raised);
    return posed(dvec3_add(w->root, dvec3(w->side * (c * out - s * up), s * out + c * up, forward)));
}

/* Slits begin off the root and end before the margin, so that the panels hold together. */
static double slit_width(double u)
{
    double open = u < 0.15 || u > 0.95 ? 0 : (u - 0.15) * (0.95 - u) / 0.16;
    return SLIT * (open < 0.25 ? 4 * open : 1);
}

static void panel_color(struct mesh_builder *b, double u, double v)
{
    double edge = 2 * fabs(v - 0.5), margin = u > 0.80 ? (u - 0.80) / 0.06 : 0, vein = edge > 0.86 ? (edge - 0.86) / 0.08 : 0;
    double dark = fmin(1, fmax(margin, vein));
    double du = (u - 0.915) / 0.030, dv = (v - 0.5) / 0.20;
    double dot = du * du + dv * dv < 1 ? 1 : 0;
    double red = 0.85 - 0.12 * u, green = 0.36 - 0.22 * u;
    mesh_builder_color(b, red + (0.02 - red) * dark + 0.8 * dot, green + (0.015 - green) * dark + 0.8 * dot, 0.03 + 0.75 * dot);
}

static void add_panel(struct mesh_builder *b, const struct wing *w, unsigned panel, unsigned rows, unsigned columns)
{
    const struct vein *near = &w->veins[panel], *far = near + 1;
    uint32_t first = mesh_builder_vertices(b);
    for (unsigned i = 0; i <= rows; i++)
        for (unsigned j = 0; j <= columns; j++) {
            double u = WING_START + (1 - WING_START) * i / rows, v = (double)j / columns;
            double length = near->length + (far->length - near->length) * v * v * (3 - 2 * v);
            double scallop = 1 - 0.05 * sin(PI * v) * u * u;
            double distance = u * length * scallop;
            double inset = fmin(slit_width(u) / distance, 0.3 * fabs(far->angle - near->angle)) * (1 - 2 * v);
            double angle = near->angle + (far->angle - near->angle) * v - inset;
            panel_color(b, u, v);
            mesh_builder_vertex(b, wing_point(w, angle, distance), dvec3(0, 1, 0));
        }
    for (unsigned i = 0; i < rows; i++)
        for (unsigned j = 0; j < columns; j++) {
            uint32_t here = first + i * (columns + 1) + j, next = here + columns + 1;
            if (w->side > 0)
                mesh_builder_quad(b, here, here + 1, next + 1, next);
            else
                mesh_builder_quad(b, here, next, next + 1, here + 1);
        }
    mesh_builder_smooth(b, first);
}

/* A hair in the middle of each slit. */
static void add_veins(struct mesh_builder *b, const struct wing *w)
{
    enum { POINTS = 25 };
    for (unsigned k = 0; k <= w->panels; k++) {
        struct dvec3 points[POINTS];
        double radii[POINTS];
        for (unsigned i = 0; i < POINTS; i++) {
            double u = 0.02 + 0.98 * i / (POINTS - 1);
            points[i] = wing_point(w, w->veins[k].angle, u * w->veins[k].length);
            radii[i] = 0.0030 - 0.0022 * u;
        }
        mesh_builder_tube(b, points, radii, POINTS, 4, false);
    }
}

static void add_hair(struct mesh_builder *b, const struct dvec3 *corners, unsigned corner_count, double thick, double thin,
                     struct dvec3 (*pose)(struct dvec3))
{
    struct dvec3 points[8];
    double radii[8];
    for (unsigned i = 0; i < corner_count; i++) {
        points[i] = pose(corners[i]);
        radii[i] = thick + (thin - thick) * i / (corner_count - 1);
    }
    mesh_builder_tube(b, points, radii, corner_count, 6, true);
}

static void add_legs(struct mesh_builder *b)
{
    for (int side = -1; side <= 1; side += 2)
        for (int pair = -1; pair <= 1; pair++) {
            double z = 0.05 + 0.045 * pair, reach = 0.12 * pair;
            const struct dvec3 leg[5] = {
                {side * 0.02, 0.40, z},
                {side * 0.12, 0.43, z + 0.4 * reach},
                {side * 0.22, 0.20, z + reach},
                {side * 0.25, 0.02, z + 1.3 * reach},
                {side * 0.29, 0.0025, z + 1.5 * reach},
            };
            add_hair(b, leg, 5, 0.0065, 0.0022, turned);
        }
}

static void add_antennae(struct mesh_builder *b)
{
    for (int side = -1; side <= 1; side += 2) {
        const struct dvec3 antenna[6] = {
            {side * 0.012, 0.50, 0.23}, {side * 0.05, 0.60, 0.30}, {side * 0.09, 0.71, 0.37},
            {side * 0.13, 0.81, 0.45},  {side * 0.17, 0.88, 0.53}, {side * 0.20, 0.91, 0.58},
        };
        add_hair(b, antenna, 6, 0.0030, 0.0018, posed);
        const struct dvec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        mesh_builder_ellipsoid(b, posed(antenna[5]), axes, (const double[]){0.009, 0.009, 0.009}, 8, 10);
    }
}

static void add_body(struct mesh_builder *b)
{
    static const struct {
        struct dvec3 center;
        double radii[3];
    } pieces[] = {
        {{0, 0.485, 0.205}, {0.040, 0.040, 0.042}},      /* head */
        {{0, 0.445, 0.080}, {0.058, 0.060, 0.110}},      /* thorax */
        {{0, 0.415, -0.180}, {0.040, 0.042, 0.210}},     /* abdomen */
        {{-0.030, 0.495, 0.222}, {0.018, 0.022, 0.022}}, /* eyes */
        {{0.030, 0.495, 0.222}, {0.018, 0.022, 0.022}},
    };
    const struct dvec3 axes[3] = {turned(dvec3(1, 0, 0)), turned(pitched(dvec3(0, 1, 0))), turned(pitched(dvec3(0, 0, 1)))};
    for (unsigned i = 0; i < sizeof pieces / sizeof pieces[0]; i++)
        mesh_builder_ellipsoid(b, posed(pieces[i].center), axes, pieces[i].radii, i < 3 ? 24 : 12, i < 3 ? 32 : 16);
}

static void make_butterfly(struct mesh_builder *b, const double *values)
{
    mesh_builder_begin(b, "body", mesh_builder_material(b, "chitin", (const float[]){0.06f, 0.045f, 0.04f}, 0.5f, false));
    add_body(b);
    add_legs(b);
    add_antennae(b);
    for (unsigned i = 0; i < 4; i++)
        add_veins(b, &wings[i]);
    double left = values[0] - 2 - mesh_builder_triangles(b);
    mesh_builder_end(b);

    unsigned panels = wings[0].panels + wings[1].panels + wings[2].panels + wings[3].panels;
    unsigned columns = (unsigned)fmax(2, round(sqrt(left / (2.0 * panels))));
    unsigned rows = (unsigned)fmax(2, round(left / (2.0 * panels * columns)));
    mesh_builder_begin_colored(b, "wings", mesh_builder_material(b, "wing", (const float[]){1, 1, 1}, 0.7f, true));
    for (unsigned i = 0; i < 4; i++)
        for (unsigned k = 0; k < wings[i].panels; k++)
            add_panel(b, &wings[i], k, rows, columns);
    mesh_builder_end(b);
    mesh_builder_stage(b);
}

static const struct builtin_param params[] = {
    {"triangles", "number of triangles, nearly; the wings take what body, legs and veins leave", 16000, 1000000, 73138, true},
    {NULL},
};

const struct builtin_scene builtin_butterfly = {
    {"butterfly", "A butterfly with paper-thin slit wings and hair-thin legs and antennae.", params}, make_butterfly};
