/* Hard cases about how triangles hang together: closed fans, degenerate triangles, open and two-sided sheets. */
#include "builtin/scenes.h"

#define PI 3.14159265358979323846

static const float grey[3] = {0.7f, 0.7f, 0.7f};
static const float clay[3] = {0.75f, 0.4f, 0.25f};
static const float slate[3] = {0.3f, 0.5f, 0.65f};

/* A closed double cone: two fans of `sides` triangles around shared points, `half_height` above and below. */
static void add_lens(struct mesh_builder *b, struct dvec3 center, double radius, double half_height, unsigned sides)
{
    uint32_t first = mesh_builder_vertices(b);
    mesh_builder_vertex(b, dvec3_add(center, dvec3(0, half_height, 0)), dvec3(0, 1, 0));
    mesh_builder_vertex(b, dvec3_add(center, dvec3(0, -half_height, 0)), dvec3(0, -1, 0));
    for (unsigned k = 0; k < sides; k++) {
        double angle = 2 * PI * k / sides;
        mesh_builder_vertex(b, dvec3_add(center, dvec3(radius * sin(angle), 0, radius * cos(angle))), dvec3(0, 1, 0));
    }
    for (unsigned k = 0; k < sides; k++) {
        uint32_t here = first + 2 + k, next = first + 2 + (k + 1) % sides;
        mesh_builder_triangle(b, first, here, next);
        mesh_builder_triangle(b, first + 1, next, here);
    }
    mesh_builder_smooth(b, first);
}

/* What is to be seen: a closed flat lens, two vertex fans of many slivers, over the floor; a ball; a bar whose shadow edge runs
 * across the fan on the lens and over the ball's shared edges.
 * Right answer: the lens's shadow on the floor is dark without a single lit pixel, above all under the fan's middle, where every
 * edge meets; so is the ball's; the bar's shadow runs straight over the fan's edges. */
static void make_fan(struct mesh_builder *b, const double *values)
{
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "lens", mesh_builder_material(b, "lens", clay, 0.9f, false));
    add_lens(b, dvec3(-0.6, 0.6, 0), 0.55, 0.05, (unsigned)values[0]);
    mesh_builder_end(b);
    mesh_builder_begin(b, "ball", mesh_builder_material(b, "ball", slate, 0.9f, false));
    const struct dvec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh_builder_ellipsoid(b, dvec3(0.75, 0.5, 0), axes, (const double[]){0.45, 0.45, 0.45}, 24, 48);
    mesh_builder_end(b);
    mesh_builder_begin(b, "bar", mesh_builder_material(b, "bar", grey, 0.9f, false));
    mesh_builder_box(b, dvec3(0, 1.4, 0.1), dvec3(2.6, 0.06, 0.06), 0.12);
    mesh_builder_end(b);
    mesh_builder_directional_light(b, dvec3_normalize(dvec3(-0.25, -1, -0.15)), 3);
    mesh_builder_camera(b, dvec3(0, 1.7, 3.6), dvec3(-0.1, 0.35, 0), 0.7);
}

static const struct builtin_param fan_params[] = {
    {"sides", "triangles in each of the lens's two fans", 3, 2048, 64, true},
    {NULL},
};

const struct builtin_scene builtin_hard_fan = {
    {"hard-06-fan", "Closed surfaces with vertex fans and shared edges under a shadow edge.", fan_params}, make_fan};

/* One useless triangle of each kind about `p`; each touches vertices that a good triangle uses too. */
static void add_bad_triangles(struct mesh_builder *b, struct dvec3 p, uint32_t good)
{
    struct dvec3 up = {0, 1, 0};
    uint32_t first = mesh_builder_vertex(b, dvec3(NAN, p.y, p.z), up);
    mesh_builder_vertex(b, dvec3(p.x, NAN, NAN), up);
    mesh_builder_vertex(b, dvec3(INFINITY, p.y, p.z), up);
    mesh_builder_vertex(b, dvec3(p.x, -INFINITY, p.z), up);
    mesh_builder_triangle(b, good, good + 1, first);
    mesh_builder_triangle(b, first, first + 1, good);
    mesh_builder_triangle(b, good + 1, first + 2, good);
    mesh_builder_triangle(b, first + 2, first + 3, good + 2);
    mesh_builder_triangle(b, good, good, good + 1); /* repeated index */
    mesh_builder_triangle(b, good + 2, good + 2, good + 2);
    /* Equal positions, different vertices; then three on one line. */
    mesh_builder_flat_triangle(b, p, p, dvec3_add(p, dvec3(0.1, 0, 0)));
    mesh_builder_flat_triangle(b, p, dvec3_add(p, dvec3(0.125, 0.25, 0)), dvec3_add(p, dvec3(0.25, 0.5, 0)));
}

/* What is to be seen: two rows of boxes and a sheet; between their triangles lie triangles of no area, collinear ones, ones that
 * repeat an index, and ones with NaN and infinite vertices.
 * Right answer: exactly the picture of bad=0, which has the good triangles alone. No bad triangle shows, casts, or widens any
 * bounds: zero-area and non-finite triangles are ignored. */
static void make_degenerate(struct mesh_builder *b, const double *values)
{
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "boxes", mesh_builder_material(b, "boxes", clay, 0.9f, true));
    for (int i = 0; i < 6; i++) {
        uint32_t good = mesh_builder_vertices(b);
        struct dvec3 p = {-1.0 + 0.9 * (i % 3), 0, i < 3 ? -0.5 : 0.4};
        mesh_builder_box(b, p, dvec3(0.3, 0.25 + 0.15 * i, 0.3), 0.3 * i);
        if (values[0] > 0)
            add_bad_triangles(b, dvec3_add(p, dvec3(0.25, 0.5, 0.1)), good);
        mesh_builder_flat_triangle(b, dvec3_add(p, dvec3(0.3, 0.2, 0)), dvec3_add(p, dvec3(0.5, 0.2, 0.2)),
                                   dvec3_add(p, dvec3(0.4, 0.6, 0.1)));
    }
    mesh_builder_end(b);
    mesh_builder_point_light(b, dvec3(2, 3.5, 2.5), 200);
    mesh_builder_camera(b, dvec3(0, 2, 3.8), dvec3(0, 0.3, 0), 0.7);
}

static const struct builtin_param degenerate_params[] = {
    {"bad", "1: with the bad triangles; 0: the good ones alone, for comparison", 0, 1, 1, true},
    {NULL},
};

const struct builtin_scene builtin_hard_degenerate = {
    {"hard-11-degenerate", "Zero-area, collinear, repeated, NaN and infinite triangles among good ones.", degenerate_params},
    make_degenerate};

/* Half a tube standing on end, open all round; outside = convex side. */
static void add_half_tube(struct mesh_builder *b, struct dvec3 foot, double radius, double height)
{
    enum { STEPS = 24 };
    uint32_t first = mesh_builder_vertices(b);
    for (int i = 0; i <= STEPS; i++) {
        double angle = PI * i / STEPS;
        struct dvec3 out = {cos(angle), 0, -sin(angle)};
        mesh_builder_vertex(b, dvec3_mad(foot, out, radius), out);
        mesh_builder_vertex(b, dvec3_add(dvec3_mad(foot, out, radius), dvec3(0, height, 0)), out);
    }
    for (uint32_t i = first; i < first + 2 * STEPS; i += 2)
        mesh_builder_quad(b, i, i + 2, i + 3, i + 1);
}

/* Three sheets that share one upright edge: no manifold has that. */
static void add_fins(struct mesh_builder *b, struct dvec3 foot)
{
    uint32_t low = mesh_builder_vertex(b, foot, dvec3(0, 0, 1));
    uint32_t high = mesh_builder_vertex(b, dvec3_add(foot, dvec3(0, 0.7, 0)), dvec3(0, 0, 1));
    for (int i = 0; i < 3; i++) {
        double angle = 2 * PI * i / 3 + 0.4;
        struct dvec3 out = {0.35 * cos(angle), 0, 0.35 * sin(angle)}, normal = {sin(angle), 0, -cos(angle)};
        uint32_t far = mesh_builder_vertex(b, dvec3_add(foot, out), normal);
        mesh_builder_vertex(b, dvec3_add(dvec3_add(foot, out), dvec3(0, 0.7, 0)), normal);
        mesh_builder_quad(b, low, high, far + 1, far);
    }
}

/* A box without its lid: five sheets, faces outward. */
static void add_open_box(struct mesh_builder *b, struct dvec3 foot, double side, double height)
{
    double h = side / 2;
    for (int i = 0; i < 4; i++) {
        double c = (i == 0) - (i == 2), s = (i == 1) - (i == 3);
        struct dvec3 left = {h * (c - s), 0, h * (s + c)}, right = {h * (c + s), 0, h * (s - c)};
        struct dvec3 p = dvec3_add(foot, left), q = dvec3_add(foot, right), up = {0, height, 0};
        mesh_builder_flat_quad(b, p, q, dvec3_add(q, up), dvec3_add(p, up));
    }
    mesh_builder_flat_quad(b, dvec3_add(foot, dvec3(-h, 0.05, -h)), dvec3_add(foot, dvec3(h, 0.05, -h)),
                           dvec3_add(foot, dvec3(h, 0.05, h)), dvec3_add(foot, dvec3(-h, 0.05, h)));
}

static void add_sheets(struct mesh_builder *b, double z)
{
    add_half_tube(b, dvec3(-1.2, 0, z), 0.3, 0.6);
    add_fins(b, dvec3(-0.3, 0, z));
    add_open_box(b, dvec3(0.5, 0, z), 0.5, 0.45);
    mesh_builder_flat_quad(b, dvec3(1.1, 0.2, z), dvec3(1.1, 0.7, z), dvec3(1.6, 0.7, z), dvec3(1.6, 0.2, z));
}

/* What is to be seen: the same four open meshes twice: half a tube, three fins on one edge, a box without a lid, an upright
 * sheet that turns its back to the camera. The back row (z < 0) is double-sided, the front row is not.
 * Right answer: in the front row faces that look away from the camera are not there for the camera (the inside of the half tube
 * and of the box's far walls, the whole upright sheet) but cast: both rows' shadows have the same shapes. */
static void make_twosided(struct mesh_builder *b, const double *values)
{
    (void)values;
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "two-sided", mesh_builder_material(b, "two-sided", slate, 0.9f, true));
    add_sheets(b, -0.7);
    mesh_builder_end(b);
    mesh_builder_begin(b, "culled", mesh_builder_material(b, "culled", clay, 0.9f, false));
    add_sheets(b, 0.7);
    mesh_builder_end(b);
    mesh_builder_directional_light(b, dvec3_normalize(dvec3(-0.5, -1, -0.3)), 3);
    mesh_builder_camera(b, dvec3(0.2, 2.6, 4.4), dvec3(0.1, 0.1, 0), 0.7);
}

const struct builtin_scene builtin_hard_twosided = {
    {"hard-20-twosided", "Two-sided, culled, open and non-manifold meshes.", NULL}, make_twosided};
