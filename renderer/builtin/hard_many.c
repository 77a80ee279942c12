/* Hard cases about amounts: in one texel, in one pixel, in memory. */
#include "builtin/scenes.h"

static const float grey[3] = {0.7f, 0.7f, 0.7f};
static const float clay[3] = {0.75f, 0.4f, 0.25f};
static const float slate[3] = {0.3f, 0.5f, 0.65f};

/* What is to be seen: two huge triangles, the roof over half of everything; a square crumb of `triangles` triangles, 0.002 across, all of it in
 * about one texel of a 1024 map, seen from near beside the roof's edge.
 * Right answer: the crumb's shadow is its square, without a lit point; the roof's edge is straight. */
static void make_million(struct mesh_builder *b, const double *values)
{
    const unsigned side = (unsigned)sqrt(values[0] / 2);
    const double crumb = 0.002, step = crumb / side;
    mesh_builder_ground(b, 40, 40, grey);
    mesh_builder_begin(b, "roof", mesh_builder_material(b, "roof", slate, 0.9f, true));
    const double edge = -0.753; /* its shadow on the floor: 0.75 further */
    mesh_builder_flat_quad(b, dvec3(-20, 3, 10), dvec3(edge, 3, 10), dvec3(edge, 3, -10), dvec3(-20, 3, -10));
    mesh_builder_end(b);
    mesh_builder_begin(b, "crumb", mesh_builder_material(b, "crumb", clay, 0.9f, true));
    uint32_t first = mesh_builder_vertices(b);
    for (unsigned j = 0; j <= side; j++)
        for (unsigned i = 0; i <= side; i++)
            mesh_builder_vertex(b, dvec3(i * step, 0.0015 + 0.0005 * hash_unit(j * 4099 + i), j * step - crumb / 2),
                                dvec3(0, 1, 0));
    for (unsigned j = 0; j < side; j++)
        for (unsigned i = 0; i < side; i++) {
            uint32_t corner = first + j * (side + 1) + i;
            mesh_builder_quad(b, corner, corner + side + 1, corner + side + 2, corner + 1);
        }
    mesh_builder_end(b);
    mesh_builder_directional_light(b, dvec3_normalize(dvec3(0.25, -1, -0.125)), 3);
    mesh_builder_camera(b, dvec3(0.001, 0.008, 0.008), dvec3(0, 0, -0.0005), 0.7);
}

static const struct builtin_param million_params[] = {
    {"triangles", "in the crumb, about", 8, 1000000, 20000, true},
    {NULL},
};

const struct builtin_scene builtin_hard_million = {
    {"hard-22-million", "Two huge triangles and up to a million that share one texel.", million_params}, make_million};

/* What is to be seen: a rough hill of facets about `pixels` wide each at 1280 x 720, with the shadow of a lattice across it.
 * Right answer: at 32 samples each facet in a pixel answers for its own samples: neither the sum of planes nor the one at the centre. */
static void make_facets(struct mesh_builder *b, const double *values)
{
    const double extent = 1.6;
    const unsigned side = (unsigned)(420 / values[0]);
    mesh_builder_begin(b, "hill", mesh_builder_material(b, "hill", clay, 0.9f, true));
    for (unsigned j = 0; j <= side; j++)
        for (unsigned i = 0; i <= side; i++) {
            double x = extent * (i / (double)side - 0.5), z = extent * (j / (double)side - 0.5);
            double rough = 0.6 * extent / side * hash_unit(j * 8191 + i);
            mesh_builder_vertex(b, dvec3(x, 0.5 * exp(-3 * (x * x + z * z)) + rough, z), dvec3(0, 1, 0));
        }
    for (unsigned j = 0; j < side; j++)
        for (unsigned i = 0; i < side; i++) {
            uint32_t corner = j * (side + 1) + i;
            mesh_builder_quad(b, corner, corner + side + 1, corner + side + 2, corner + 1);
        }
    mesh_builder_smooth(b, 0);
    mesh_builder_end(b);
    mesh_builder_begin(b, "lattice", mesh_builder_material(b, "lattice", slate, 0.9f, false));
    for (int i = 0; i < 6; i++) {
        mesh_builder_box(b, dvec3(0.9, 1 + 0.02 * i, -0.5 + 0.2 * i), dvec3(1.2, 0.03, 0.03), 0.1 * i);
        mesh_builder_box(b, dvec3(0.4 + 0.2 * i, 1.2, 0), dvec3(0.03, 0.03, 1.2), 0.05 * i);
    }
    mesh_builder_end(b);
    mesh_builder_point_light(b, dvec3(2.2, 2.6, 0.4), 60);
    mesh_builder_camera(b, dvec3(-0.4, 1.3, 2.2), dvec3(-0.05, 0.15, 0), 0.6);
}

static const struct builtin_param facets_params[] = {
    {"pixels", "width of a facet in pixels at 1280x720", 0.5, 40, 3, false},
    {NULL},
};

const struct builtin_scene builtin_hard_facets = {
    {"hard-23-facets", "Two to five visible triangles in a pixel under a shadow edge.", facets_params}, make_facets};

/* What is to be seen: `sheets` square sheets one above the other, each a little turned, seen from the side, lit from straight above.
 * Right answer: only the top one and what sticks out under it is lit. Every texel of a map is covered by nearly every sheet: lists of all
 * triangles a texel hold sheets x texels entries and reach any memory budget (--memory); then slower, never wrong, or a clear error. */
static void make_sheets(struct mesh_builder *b, const double *values)
{
    unsigned sheets = (unsigned)values[0];
    mesh_builder_ground(b, 12, 12, grey);
    mesh_builder_begin(b, "sheets", mesh_builder_material(b, "sheets", clay, 0.9f, true));
    for (unsigned k = 0; k < sheets; k++) {
        double y = 0.2 + 1.2 * k / sheets, turn = 0.7 * k / sheets, c = 0.6 * cos(turn), s = 0.6 * sin(turn);
        mesh_builder_flat_quad(b, dvec3(-c, y, -s), dvec3(-s, y, c), dvec3(c, y, s), dvec3(s, y, -c));
    }
    mesh_builder_end(b);
    mesh_builder_directional_light(b, dvec3_normalize(dvec3(-0.1, -1, -0.05)), 3);
    mesh_builder_camera(b, dvec3(0.6, 1.9, 3.2), dvec3(0, 0.5, 0), 0.7);
}

static const struct builtin_param sheets_params[] = {
    {"sheets", "one above the other", 1, 4096, 64, true},
    {NULL},
};

const struct builtin_scene builtin_hard_sheets = {
    {"hard-25-sheets", "Sheets upon sheets: every texel holds nearly all of them.", sheets_params}, make_sheets};
