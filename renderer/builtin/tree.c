/* A tree in full leaf, after the kind "tree" of the coverage shadow map paper (Li et al. 2017, table 2: 46,036 triangles): many
 * small leaves, each cut out as geometry, one over the other seen from the light. */
#include "builtin/scenes.h"

#define LEVELS 4
#define PI     3.14159265358979323846

struct level {
    unsigned segments, sides, children;
    double length, spread; /* of a branch, relative to its parent's; radians between it and its parent */
    double thinning;       /* radius at the end, relative to the start's */
    double first_child;    /* where along the branch children start, [0,1] */
};

static const struct level levels[LEVELS] = {
    {12, 14, 11, 1.40, 0.00, 0.30, 0.34},
    {8, 8, 7, 0.64, 1.05, 0.30, 0.25},
    {5, 5, 5, 0.56, 0.85, 0.35, 0.20},
    {4, 4, 0, 0.62, 0.75, 0.40, 0.00},
};

struct twig {
    struct dvec3 start, end;
};

struct tree {
    struct mesh_builder *b;
    uint32_t draws;           /* of random numbers so far */
    ARRAY(struct twig) twigs; /* pieces of branch that bear leaves */
};

struct branch {
    unsigned level;
    struct dvec3 start, direction;
    double length, radius;
};

#define MAX_SEGMENTS 12

static double draw(struct tree *t, double low, double high) { return low + (high - low) * hash_unit(t->draws++); }

static struct dvec3 draw_direction(struct tree *t)
{
    double y = draw(t, -1, 1), angle = draw(t, 0, 2 * PI), r = sqrt(1 - y * y);
    return dvec3(r * cos(angle), y, r * sin(angle));
}

/* The branch's middle line: it wanders a little and turns towards the light. */
static void grow_line(struct tree *t, const struct branch *branch, struct dvec3 *points, double *radii)
{
    const struct level *level = &levels[branch->level];
    struct dvec3 p = branch->start, d = branch->direction;
    double step = branch->length / level->segments;
    for (unsigned i = 0; i <= level->segments; i++) {
        double along = (double)i / level->segments;
        double root = branch->level == 0 ? 0.5 * exp(-14 * along) : 0; /* the trunk widens at its foot */
        points[i] = p;
        radii[i] = branch->radius * (1 + (level->thinning - 1) * along + root);
        p = dvec3_mad(p, d, step);
        d = dvec3_mad(d, draw_direction(t), branch->level == 0 ? 0.10 : 0.20);
        d = dvec3_normalize(dvec3_add(d, dvec3(0, branch->level == 0 ? 0.2 : 0.07, 0)));
    }
}

static void bear_leaves(struct tree *t, const struct dvec3 *points, unsigned segments)
{
    for (unsigned i = 0; i < segments; i++) {
        struct twig twig = {points[i], points[i + 1]};
        if (!array_push(&t->twigs, twig))
            t->b->failed = true;
    }
}

static struct branch make_child(struct tree *t, const struct branch *parent, struct dvec3 start, struct dvec3 along,
                                unsigned number)
{
    const struct level *level = &levels[parent->level + 1];
    struct dvec3 side = dvec3_normalize(dvec3_cross(fabs(along.y) < 0.8 ? dvec3(0, 1, 0) : dvec3(1, 0, 0), along));
    double around = number * 2.39996 + draw(t, -0.4, 0.4); /* the golden angle, as leaves and branches stand */
    double spread = level->spread * draw(t, 0.75, 1.15);
    struct dvec3 out = dvec3_mad(dvec3_scale(side, cos(around)), dvec3_cross(along, side), sin(around));
    return (struct branch){
        .level = parent->level + 1,
        .start = start,
        .direction = dvec3_normalize(dvec3_mad(dvec3_scale(along, cos(spread)), out, sin(spread))),
        .length = parent->length * level->length * draw(t, 0.75, 1.1),
    };
}

static void grow(struct tree *t, struct branch branch)
{
    const struct level *level = &levels[branch.level];
    struct dvec3 points[MAX_SEGMENTS + 1];
    double radii[MAX_SEGMENTS + 1];
    grow_line(t, &branch, points, radii);
    mesh_builder_tube(t->b, points, radii, level->segments + 1, level->sides, true);
    if (branch.level + 2 >= LEVELS)
        bear_leaves(t, points, level->segments);
    for (unsigned i = 0; i < level->children; i++) {
        double where = level->first_child + (0.97 - level->first_child) * (i + draw(t, 0.2, 0.8)) / level->children;
        unsigned segment = (unsigned)(where * level->segments);
        double rest = where * level->segments - segment;
        struct dvec3 piece = dvec3_sub(points[segment + 1], points[segment]);
        struct branch child = make_child(t, &branch, dvec3_mad(points[segment], piece, rest), dvec3_normalize(piece), i);
        child.length *= 1.15 - 0.55 * where; /* lower ones are longer: a round crown */
        child.radius = 0.55 * (radii[segment] + rest * (radii[segment + 1] - radii[segment]));
        grow(t, child);
    }
}

/* A diamond, folded a little along its middle: two triangles. */
static void add_leaf(struct tree *t, const struct twig *twig)
{
    struct dvec3 base = dvec3_mad(twig->start, dvec3_sub(twig->end, twig->start), draw(t, 0, 1));
    struct dvec3 along = dvec3_normalize(dvec3_sub(twig->end, twig->start));
    struct dvec3 axis = dvec3_normalize(dvec3_add(dvec3_mad(draw_direction(t), along, 0.6), dvec3(0, -0.25, 0)));
    struct dvec3 side = dvec3_normalize(dvec3_cross(axis, draw_direction(t)));
    struct dvec3 normal = dvec3_cross(side, axis);
    double length = draw(t, 0.060, 0.100), width = length * draw(t, 0.20, 0.30), fold = draw(t, 0, 0.35) * width;
    struct dvec3 middle = dvec3_mad(dvec3_mad(base, axis, 0.45 * length), normal, fold);
    double light = draw(t, 0.7, 1.15), yellow = draw(t, 0, 1);
    mesh_builder_color(t->b, (0.14 + 0.18 * yellow * yellow) * light, 0.33 * light, 0.07 * light);
    uint32_t first = mesh_builder_vertex(t->b, base, normal);
    mesh_builder_vertex(t->b, dvec3_mad(middle, side, width), normal);
    mesh_builder_vertex(t->b, dvec3_mad(base, axis, length), normal);
    mesh_builder_vertex(t->b, dvec3_mad(middle, side, -width), normal);
    mesh_builder_quad(t->b, first, first + 1, first + 2, first + 3);
}

static void make_tree(struct mesh_builder *b, const double *values)
{
    struct tree t = {.b = b};
    mesh_builder_begin(b, "wood", mesh_builder_material(b, "bark", (const float[]){0.26f, 0.17f, 0.10f}, 0.95f, false));
    grow(&t, (struct branch){.direction = {0, 1, 0}, .length = levels[0].length, .radius = 0.075});
    mesh_builder_end(b);
    mesh_builder_begin_colored(b, "leaves", mesh_builder_material(b, "leaf", (const float[]){1, 1, 1}, 0.6f, true));
    for (unsigned i = 0; i < (unsigned)values[0] && !b->failed; i++)
        add_leaf(&t, &t.twigs.data[hash_uint32(~i) % t.twigs.count]);
    mesh_builder_end(b);
    array_finish(&t.twigs);
    mesh_builder_stage(b);
}

static const struct builtin_param params[] = {
    {"leaves", "number of leaves, two triangles each", 0, 500000, 12033, true},
    {NULL},
};

const struct builtin_scene builtin_tree = {{"tree", "A tree with many overlapping leaves, each cut out as geometry.", params},
                                           make_tree};
