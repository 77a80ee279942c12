#include "hard_scenes.h"

#include <stdlib.h>

/* Numerical Recipes' quick generator: the same scenes everywhere. */
static double drawn(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / 16777216.0 * 2 - 1;
}

static void floor_at(struct scene *scene, float y, float size, uint32_t material)
{
    const float p[6][3] = {{-size, y, -size}, {-size, y, size}, {size, y, size},
                           {-size, y, -size}, {size, y, size},  {size, y, -size}};
    made_triangles(scene, p, 6, material);
}

static struct scene *soup(void)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true), seed = 7;
    float p[3 * 18][3];
    for (int t = 0; t < 18; t++) {
        float c[3] = {(float)drawn(&seed), (float)(drawn(&seed) * 0.6 + 0.3), (float)drawn(&seed)};
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++)
                p[3 * t + k][i] = c[i] + (float)(0.5 * drawn(&seed));
    }
    made_triangles(scene, (const float(*)[3])p, 3 * 18, material);
    floor_at(scene, -1, 3, material);
    made_finish(scene);
    return scene;
}

static struct scene *slivers(void)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true), seed = 11;
    float p[3 * 14][3];
    for (int t = 0; t < 14; t++) {
        float x = (float)(t - 7) * 0.15f, thin = t % 2 ? 1e-5f : 1e-3f;
        float top = 1 + (float)drawn(&seed) * 0.3f;
        const float corners[3][3] = {{x, -0.9f, 0.1f}, {x + thin, -0.9f, 0.1f}, {x + 0.2f, top, (float)drawn(&seed) * 0.4f}};
        for (int k = 0; k < 9; k++)
            p[3 * t + k / 3][k % 3] = corners[k / 3][k % 3];
    }
    made_triangles(scene, (const float(*)[3])p, 3 * 14, material);
    floor_at(scene, -1, 3, material);
    made_finish(scene);
    return scene;
}

static void wall_behind(struct scene *scene, uint32_t material)
{
    const float wall[6][3] = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
    made_triangles(scene, wall, 6, material);
}

/* A closed disc of shared edges between a wall and the light on its axis. */
static struct scene *fan(void)
{
    enum { BLADES = 8 };
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true), indices[3 * BLADES];
    float p[BLADES + 1][3] = {{0, 0, 2}};
    static const float ring[BLADES][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
    for (uint32_t i = 0; i < BLADES; i++) {
        p[i + 1][0] = ring[i][0];
        p[i + 1][1] = ring[i][1];
        p[i + 1][2] = 2;
        indices[3 * i] = 0;
        indices[3 * i + 1] = i + 1;
        indices[3 * i + 2] = (i + 1) % BLADES + 1;
    }
    made_instance(scene, made_mesh(scene, (const float(*)[3])p, NULL, BLADES + 1, indices, 3 * BLADES, material),
                  affine_identity());
    wall_behind(scene, material);
    made_finish(scene);
    return scene;
}

static const float cube[8][3] = {{-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 2, 1}, {-1, 2, 1}};
static const uint32_t cube_indices[36] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                          3, 6, 2, 3, 7, 6, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5};

static struct affine turned(double degrees, double scale, double mirror)
{
    struct affine a = affine_identity();
    double c = cos(degrees * M_PI / 180) * scale, s = sin(degrees * M_PI / 180) * scale;
    a.linear[0][0] = c * mirror;
    a.linear[0][2] = s;
    a.linear[1][1] = scale;
    a.linear[2][0] = -s * mirror;
    a.linear[2][2] = c;
    return a;
}

/* A box standing on the floor, in the same plane; a second one turned, so that its foot is off by roundings. */
static struct scene *contact(void)
{
    struct scene *scene = made_scene();
    uint32_t one_sided = made_material(scene, false);
    uint32_t box = made_mesh(scene, cube, NULL, 8, cube_indices, 36, one_sided);
    made_instance(scene, box, turned(0, 0.5, 1));
    struct affine second = turned(30, 0.3, -1);
    second.linear[1][0] = 1e-17;
    second.offset[0] = 1.3;
    made_instance(scene, box, second);
    floor_at(scene, 0, 4, one_sided);
    made_finish(scene);
    return scene;
}

/* Integer corners, seen and lit along the grid: edges and corners fall exactly on picture positions. */
static struct scene *grid(void)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true), indices[6 * 16];
    float p[25][3];
    for (uint32_t i = 0; i < 25; i++) {
        p[i][0] = (float)(i % 5) - 2;
        p[i][1] = (float)(i / 5) - 2;
        p[i][2] = 1 + (float)(i * 7 % 3);
    }
    for (uint32_t q = 0; q < 16; q++) {
        uint32_t a = q / 4 * 5 + q % 4;
        const uint32_t quad[6] = {a, a + 1, a + 6, a, a + 6, a + 5};
        for (int k = 0; k < 6; k++)
            indices[6 * q + (uint32_t)k] = quad[k];
    }
    made_instance(scene, made_mesh(scene, (const float(*)[3])p, NULL, 25, indices, 96, material), affine_identity());
    wall_behind(scene, material);
    made_finish(scene);
    return scene;
}

/* Corners on small integers: shared corners, coplanar neighbours and planes through the light in plenty. */
static struct scene *lattice(void)
{
    struct scene *scene = made_scene();
    uint32_t seed = 23;
    float p[3 * 30][3];
    for (int k = 0; k < 3 * 30; k++) {
        p[k][0] = (float)round(2 * drawn(&seed));
        p[k][1] = (float)round(2 * drawn(&seed));
        p[k][2] = 2 + (float)round(drawn(&seed));
    }
    made_triangles(scene, (const float(*)[3])p, 3 * 15, made_material(scene, true));
    made_triangles(scene, (const float(*)[3])(p + 3 * 15), 3 * 15, made_material(scene, false));
    wall_behind(scene, 0);
    made_finish(scene);
    return scene;
}

static struct scene *leaves(void)
{
    struct scene *scene = made_scene();
    uint32_t leaf = made_material(scene, true), ground = made_material(scene, false), seed = 5;
    uint8_t solid[64];
    for (int i = 0; i < 64; i++)
        solid[i] = (i / 8 + i) % 3 != 0;
    made_mask(scene, leaf, 8, solid);
    for (int k = 0; k < 3; k++) {
        float p[4][3];
        static const float uv[4][2] = {{-0.5f, 0}, {2, 0.25f}, {2, 2}, {0, 1.5f}};
        static const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
        for (int i = 0; i < 4; i++) {
            p[i][0] = (i == 1 || i == 2 ? 1.0f : -1.0f) + 0.2f * (float)drawn(&seed);
            p[i][1] = (i >= 2 ? 1.0f : -0.8f) + 0.2f * (float)drawn(&seed);
            p[i][2] = 0.4f * (float)k + 0.2f * (float)drawn(&seed);
        }
        made_instance(scene, made_mesh(scene, (const float(*)[3])p, uv, 4, indices, 6, leaf), affine_identity());
    }
    floor_at(scene, -1, 3, ground);
    made_finish(scene);
    return scene;
}

/* The same triangle several times, turned over, and its copy a little larger in the same plane. */
static struct scene *duplicates(void)
{
    struct scene *scene = made_scene();
    uint32_t both = made_material(scene, true), one = made_material(scene, false);
    const float p[12][3] = {{-1, 0, 0}, {1, 0.1f, 0.3f}, {0, 1.2f, 0.1f}, {1, 0.1f, 0.3f}, {-1, 0, 0},      {0, 1.2f, 0.1f},
                            {-1, 0, 0}, {1, 0.1f, 0.3f}, {0, 1.2f, 0.1f}, {-1, 0, 0},      {0, 1.2f, 0.1f}, {1, 0.1f, 0.3f}};
    made_triangles(scene, p, 12, one);
    made_triangles(scene, p, 6, both);
    const float wide[6][3] = {{-2, -1, 0.5f}, {2, -1, 0.5f}, {0, 0.5f, -0.25f},
                              {-1, -1, 0.5f}, {1, -1, 0.5f}, {0, -0.25f, 0.125f}};
    made_triangles(scene, wide, 6, both);
    floor_at(scene, -1, 3, one);
    made_finish(scene);
    return scene;
}

static struct scene *broken(void)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true);
    float p[][3] = {{-1, -0.5f, 0}, {1, -0.5f, 0}, {0, 1, 0},   {-1, 0, 1}, {0, 0, 1},        {1, 0, 1},        {0, 0, 1},
                    {0, 0, 1},      {1, 1, 1},     {NAN, 0, 1}, {0, 1, 1},  {1, 0, 1},        {0, INFINITY, 1}, {0, 1, 1},
                    {1, 0, 1},      {2e18f, 0, 1}, {0, 1, 1},   {1, 0, 1},  {-0.5f, 0, 0.5f}, {0.5f, 0, 0.5f},  {0, 0.5f, 0.5f}};
    made_triangles(scene, (const float(*)[3])p, sizeof p / sizeof p[0], material);
    floor_at(scene, -1, 3, material);
    made_finish(scene);
    return scene;
}

/* Around the light at (0.2, 1, 0.1): triangles through its planes, and 1e-3 beside it. */
static struct scene *round_the_light(void)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true);
    const float p[12][3] = {{-1, 1, -1},
                            {1, 1, -1},
                            {0, 1, 1},
                            {0.2f, 0, 0.1f},
                            {0.2f, 2, 1},
                            {0.2f, 2, -1},
                            {-0.3f, 0.999f, -0.3f},
                            {0.3f, 0.999f, -0.3f},
                            {0.1f, 0.999f, 0.4f},
                            {-1, 0.5f, 0.2f},
                            {0.8f, 1.6f, 0.3f},
                            {-0.6f, 1.8f, -0.7f}};
    made_triangles(scene, p, 12, material);
    floor_at(scene, -1, 3, material);
    made_finish(scene);
    return scene;
}

/* Shadows as thin as the light's rays allow: the light lies in the floor's plane, or 1e-4 above it. */
static struct scene *grazing(void)
{
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, false);
    made_instance(scene, made_mesh(scene, cube, NULL, 8, cube_indices, 36, material), turned(13, 0.4, 1));
    floor_at(scene, 0, 4, material);
    floor_at(scene, -0.0001f, 5, material);
    made_finish(scene);
    return scene;
}

const struct hard_scene hard_scenes[] = {
    {"soup", soup, {1.1, 1.3, 4}, {0, 0, 0}, {1.5, 4, 2}, false},
    {"slivers", slivers, {0.6, 1.1, 3.5}, {0, -0.2, 0}, {0.4, 3, 4}, false},
    {"fan", fan, {0, 0, 0.75}, {0, 0, 0}, {0, 0, 4}, true},
    {"contact", contact, {1.5, 2, 4}, {0.4, 0.3, 0}, {2, 3, 1}, false},
    {"grid", grid, {0, 0, 8}, {0, 0, 0}, {0, 0, 6}, true},
    {"grid-shadow", grid, {0, 0, 0.5}, {0, 0, 0}, {0, 0, 6}, true},
    {"lattice", lattice, {0, 0, 8}, {0, 0, 0}, {1, 1, 6}, true},
    {"lattice-shadow", lattice, {0, 0, 0.5}, {0, 0, 0}, {1, 1, 6}, true},
    {"leaves", leaves, {0.5, 1.5, 4}, {0, 0, 0}, {1, 3, 3}, false},
    {"duplicates", duplicates, {0.3, 0.8, 4}, {0, 0, 0}, {0.5, 3, 2}, false},
    {"broken", broken, {0.2, 0.6, 4}, {0, 0, 0}, {0.5, 3, 2}, false},
    {"round-the-light", round_the_light, {0.7, 1.9, 4.5}, {0, 0.3, 0}, {0.2f, 1, 0.1f}, false},
    {"grazing", grazing, {1, 1.5, 4}, {0, 0.2, 0}, {-3, 0.0005, 0.5}, false},
    {"in-plane", grazing, {1, 1.5, 4}, {0, 0, 0}, {-3, 0, 0.5}, false},
};
const size_t hard_scene_count = sizeof hard_scenes / sizeof hard_scenes[0];
