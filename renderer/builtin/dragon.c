/* A dense closed surface with shadows of its own at every scale, in place of the Stanford dragon of the coverage shadow map
 * paper (Li et al. 2017, table 2: about 871,000 triangles): body, legs, toes and horns are closed swept surfaces that reach into
 * one another; scales, spikes and wrinkles are displacements. Every edge has exactly two triangles. */
#include "builtin/scenes.h"
#include "builtin/sweep.h"

#define PI       3.14159265358979323846
#define COUNT(a) (sizeof(a) / sizeof(a)[0])

static const struct sweep_knot body[] = {
    {{-0.30, 0.060, 0.66}, 0.006, {0, 1, 0}},        {{-0.60, 0.065, 0.64}, 0.020, {0, 1, 0}},
    {{-0.88, 0.075, 0.46}, 0.036, {0, 1, 0}},        {{-1.00, 0.100, 0.16}, 0.052, {0, 1, 0}},
    {{-0.94, 0.180, -0.14}, 0.078, {0, 1, 0}},       {{-0.70, 0.330, -0.32}, 0.115, {0, 1, 0}},
    {{-0.38, 0.490, -0.28}, 0.165, {0, 1, 0}},       {{-0.06, 0.540, -0.12}, 0.185, {0, 1, 0}},
    {{0.24, 0.590, 0.02}, 0.190, {0, 1, 0}},         {{0.47, 0.740, 0.08}, 0.135, {-0.7, 0.7, 0}},
    {{0.58, 0.960, 0.04}, 0.098, {-1, 0.2, 0}},      {{0.57, 1.190, -0.02}, 0.084, {-1, 0.2, 0}},
    {{0.62, 1.390, 0.04}, 0.082, {-0.7, 0.7, -0.3}}, {{0.74, 1.480, 0.18}, 0.108, {0, 1, 0}},
    {{0.84, 1.445, 0.33}, 0.096, {0, 1, 0}},         {{0.91, 1.390, 0.46}, 0.070, {0, 1, 0}},
    {{0.95, 1.350, 0.55}, 0.058, {0, 1, 0}},
};

/* Hip or shoulder, knee, heel, foot. */
static const struct sweep_knot legs[4][5] = {
    {{{0.20, 0.60, 0.10}, 0.110, {1, 0, 0}},
     {{0.26, 0.40, 0.25}, 0.092, {1, 0, 0}},
     {{0.20, 0.20, 0.30}, 0.055, {1, 0, 0}},
     {{0.27, 0.06, 0.33}, 0.045, {1, 0.5, 0}},
     {{0.37, 0.04, 0.37}, 0.036, {0, 1, 0}}},
    {{{0.26, 0.58, -0.06}, 0.110, {1, 0, 0}},
     {{0.36, 0.40, -0.20}, 0.092, {1, 0, 0}},
     {{0.30, 0.20, -0.25}, 0.055, {1, 0, 0}},
     {{0.37, 0.06, -0.27}, 0.045, {1, 0.5, 0}},
     {{0.48, 0.04, -0.27}, 0.036, {0, 1, 0}}},
    {{{-0.42, 0.48, -0.20}, 0.130, {1, 0, 0}},
     {{-0.36, 0.32, -0.02}, 0.112, {1, 0, 0}},
     {{-0.50, 0.18, 0.05}, 0.058, {1, 0, 0}},
     {{-0.46, 0.06, 0.09}, 0.046, {1, 0.5, 0}},
     {{-0.35, 0.04, 0.14}, 0.038, {0, 1, 0}}},
    {{{-0.46, 0.48, -0.36}, 0.130, {1, 0, 0}},
     {{-0.32, 0.32, -0.50}, 0.112, {1, 0, 0}},
     {{-0.44, 0.18, -0.60}, 0.058, {1, 0, 0}},
     {{-0.38, 0.06, -0.63}, 0.046, {1, 0.5, 0}},
     {{-0.27, 0.04, -0.64}, 0.038, {0, 1, 0}}},
};

static const struct sweep_knot horns[2][4] = {
    {{{0.76, 1.54, 0.14}, 0.034, {0, 1, 0}},
     {{0.78, 1.66, 0.04}, 0.028, {1, 0, 0}},
     {{0.76, 1.72, -0.10}, 0.018, {1, 0, 0}},
     {{0.78, 1.82, -0.22}, 0.003, {1, 0, 0}}},
    {{{0.68, 1.54, 0.20}, 0.034, {0, 1, 0}},
     {{0.58, 1.66, 0.16}, 0.028, {1, 0, 0}},
     {{0.44, 1.72, 0.08}, 0.018, {0, 0, 1}},
     {{0.36, 1.82, 0.00}, 0.003, {0, 0, 1}}},
};

/* A smooth hill of width 1 about 0. */
static double hill(double x) { return exp(-x * x); }

/* Overlapping scales, [0,1]: rows across the body, every other one shifted by half a scale; each rises to its tip. */
static double scales(double along, double angle, double length, unsigned around)
{
    double row = floor(along / length), part = along / length - row;
    double column = angle / (2 * PI) * around + ((int)row & 1 ? 0.5 : 0);
    double across = 2 * (column - floor(column + 0.5));
    double reach = 1 - across * across, tip = part < 0.2 ? part / 0.2 : 1 - 0.75 * (part - 0.2) / 0.8;
    return reach * tip;
}

static double wrinkles(struct dvec3 p)
{
    return 0.6 * noise3(dvec3_scale(p, 14)) + 0.3 * noise3(dvec3_scale(p, 41)) + 0.12 * noise3(dvec3_scale(p, 127));
}

/* Brows, eyes, nostrils and the line of the mouth; `from_nose` in scene units. */
static double face(double from_nose, double angle)
{
    double a = fabs(angle);
    double brow = 0.030 * hill((from_nose - 0.27) / 0.05) * hill((a - 0.75) / 0.22);
    double eye = 0.016 * hill((from_nose - 0.235) / 0.024) * hill((a - 1.15) / 0.20) -
                 0.016 * hill((from_nose - 0.235) / 0.045) * hill((a - 1.15) / 0.36);
    double nostril = 0.016 * hill((from_nose - 0.06) / 0.022) * hill((a - 0.55) / 0.25);
    double mouth = -0.022 * hill((a - 1.85) / 0.10) * (from_nose < 0.26 ? 1 : hill((from_nose - 0.26) / 0.03));
    double jaw = 0.020 * hill((from_nose - 0.34) / 0.06) * hill((a - 1.9) / 0.35);
    return brow + eye + nostril + mouth + jaw;
}

static double displace_body(struct mesh_builder *b, const struct sweep_place *p)
{
    double from_nose = p->length - p->along, head = from_nose < 0.42 ? 1 - from_nose / 0.42 : 0;
    double back = 0.5 + 0.5 * cos(p->angle), belly = p->angle > 2.2 || p->angle < -2.2 ? 1 : 0;
    double scale = belly > 0 ? scales(p->along, 0, 0.050, 1) : scales(p->along, p->angle, 0.036, 26);
    double wave = 0.5 + 0.5 * cos(2 * PI * p->along / 0.092);
    double spike = hill(p->angle / 0.13) * wave * wave * wave * (from_nose > 0.40 ? 1 : hill((from_nose - 0.40) / 0.05));
    double calm = 1 - 0.7 * (head > 0.4 ? 1 : head / 0.4);
    mesh_builder_color(b, 0.20 + 0.42 * (1 - back) + 0.35 * spike, 0.36 + 0.10 * (1 - back) - 0.14 * spike, 0.20 - 0.10 * spike);
    return p->radius * (0.085 * calm * scale + 0.05 * wrinkles(p->position) + 0.62 * spike) +
           (from_nose < 0.6 ? face(from_nose, p->angle) * (p->radius > 0.03 ? 1 : p->radius / 0.03) : 0);
}

static double displace_leg(struct mesh_builder *b, const struct sweep_place *p)
{
    double down = p->along / p->length;
    mesh_builder_color(b, 0.24 + 0.22 * down, 0.38 + 0.04 * down, 0.20);
    return p->radius * (0.08 * scales(p->along, p->angle, 0.030, 18) + 0.07 * wrinkles(p->position));
}

static double displace_horn(struct mesh_builder *b, const struct sweep_place *p)
{
    mesh_builder_color(b, 0.70, 0.62, 0.46);
    return p->radius * (0.10 * (0.5 + 0.5 * cos(2 * PI * p->along / 0.024)) + 0.04 * wrinkles(p->position));
}

static void add_part(struct mesh_builder *b, const struct sweep *part, uint32_t triangles, double slimness)
{
    unsigned rings, sides;
    sweep_grid(triangles, slimness, &rings, &sides);
    sweep_add(b, part, rings, sides);
}

/* Three claws at the end of a leg. */
static void add_toes(struct mesh_builder *b, const struct sweep_knot *foot, uint32_t triangles)
{
    for (int i = -1; i <= 1; i++) {
        const double *p = foot->position;
        double turn = 0.45 * i, c = cos(turn), s = sin(turn);
        const struct sweep_knot knots[3] = {
            {{p[0] - 0.02 * c, p[1], p[2] + 0.02 * i}, 0.024, {0, 1, 0}},
            {{p[0] + 0.05 * c, p[1] + 0.01, p[2] + 0.05 * s + 0.02 * i}, 0.020, {0, 1, 0}},
            {{p[0] + 0.11 * c, p[1] - 0.03, p[2] + 0.11 * s + 0.02 * i}, 0.003, {0, 1, 0}},
        };
        add_part(b, &(struct sweep){knots, 3, displace_horn}, triangles, 1.2);
    }
}

static void make_dragon(struct mesh_builder *b, const double *values)
{
    double wanted = values[0] - 2; /* the ground has two */
    mesh_builder_begin_colored(b, "dragon", mesh_builder_material(b, "scales", (const float[]){1, 1, 1}, 0.55f, false));
    for (unsigned i = 0; i < 4; i++) {
        add_part(b, &(struct sweep){legs[i], 5, displace_leg}, (uint32_t)(wanted * 0.065), 1.6);
        add_toes(b, &legs[i][4], (uint32_t)(wanted * 0.004));
    }
    for (unsigned i = 0; i < 2; i++)
        add_part(b, &(struct sweep){horns[i], 4, displace_horn}, (uint32_t)(wanted * 0.012), 3);
    add_part(b, &(struct sweep){body, COUNT(body), displace_body}, (uint32_t)wanted - mesh_builder_triangles(b), 5.5);
    mesh_builder_smooth(b, 0);
    mesh_builder_stand(b);
    mesh_builder_end(b);
    mesh_builder_stage(b);
}

static const struct builtin_param params[] = {
    {"triangles", "number of triangles, the ground's two included", 1000, 2500000, 870000, true},
    {NULL},
};

const struct builtin_scene builtin_dragon = {{"dragon", "A dragon with scales and spikes: one dense, closed surface.", params},
                                             make_dragon};
