/* The hard case about holes. */
#include <stdlib.h>

#include "builtin/scenes.h"

#define PI 3.14159265358979323846

/* A leaf's outline with a notched edge and a few holes, as alpha; NULL when memory is out. */
static uint8_t *paint_leaf(uint32_t side)
{
    uint8_t *rgba = malloc((size_t)side * side * 4);
    if (!rgba)
        return NULL;
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++) {
            double u = (x + 0.5) / side * 2 - 1, v = (y + 0.5) / side;
            double half = 0.9 * sin(PI * pow(v, 0.8)) * (0.85 + 0.15 * cos(40 * v));
            bool hole = fabs(fabs(u) - 0.35 * half) < 0.08 && fmod(v * 7, 1) < 0.35;
            uint8_t *texel = rgba + 4 * ((size_t)y * side + x);
            texel[0] = 60;
            texel[1] = (uint8_t)(120 + 60 * v);
            texel[2] = 40;
            texel[3] = fabs(u) < half && !hole ? 255 : 0;
        }
    return rgba;
}

/* A square card, its texture's v running from `foot` to the tip. */
static void add_card(struct mesh_builder *b, struct dvec3 foot, double side, double turn, double lean)
{
    struct dvec3 across = {side * cos(turn), 0, side * sin(turn)};
    struct dvec3 up = {-side * lean * sin(turn), side * sqrt(1 - lean * lean), side * lean * cos(turn)};
    struct dvec3 normal = dvec3_normalize(dvec3_cross(across, up)), left = dvec3_mad(foot, across, -0.5);
    uint32_t first = mesh_builder_vertices(b);
    for (int i = 0; i < 4; i++) {
        mesh_builder_texcoord(b, i == 1 || i == 2, i >= 2);
        mesh_builder_vertex(b, dvec3_add(left, dvec3_add(dvec3_scale(across, i == 1 || i == 2), dvec3_scale(up, i >= 2))),
                            normal);
    }
    mesh_builder_quad(b, first, first + 1, first + 2, first + 3);
}

/* What is to be seen: cards with a leaf cut out by alpha (MASK), one large in front, a bush of small ones behind.
 * Right answer: the shadow has the leaf's outline, texel-exact: the same nearest-texel rule in the camera's picture, in the reference and in
 * the maps, on both sides of a card; a leaf shades another, never its own card. */
static void make_cards(struct mesh_builder *b, const double *values)
{
    mesh_builder_ground(b, 12, 12, (const float[]){0.7f, 0.7f, 0.7f});
    uint32_t leaf = mesh_builder_material(b, "leaf", (const float[]){1, 1, 1}, 0.8f, true);
    mesh_builder_cut_out(b, leaf, 64, paint_leaf(64));
    mesh_builder_begin_textured(b, "cards", leaf);
    add_card(b, dvec3(-0.7, 0, 0.5), 0.9, 0.3, 0.2);
    for (uint32_t i = 0; i < (uint32_t)values[0]; i++) {
        struct dvec3 foot = {0.8 + 0.6 * hash_unit(5 * i), 0.9 * hash_unit(5 * i + 1), -0.3 + 0.8 * hash_unit(5 * i + 2)};
        add_card(b, foot, 0.25, 2 * PI * hash_unit(5 * i + 3), 0.9 * hash_unit(5 * i + 4));
    }
    mesh_builder_end(b);
    mesh_builder_directional_light(b, dvec3_normalize(dvec3(-0.4, -1, -0.6)), 3);
    mesh_builder_camera(b, dvec3(0.2, 1.9, 3.6), dvec3(0.1, 0.35, 0), 0.7);
}

static const struct builtin_param cards_params[] = {
    {"leaves", "in the bush", 1, 20000, 120, true},
    {NULL},
};

const struct builtin_scene builtin_hard_cards = {
    {"hard-19-cards", "Leaf cards with holes cut by alpha, seen and lit from both sides.", cards_params}, make_cards};
