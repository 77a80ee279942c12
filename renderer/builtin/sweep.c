#include "builtin/sweep.h"

#include <math.h>

#define PI           3.14159265358979323846
#define LENGTH_STEPS 1024 /* of the table that turns length into spline parameter */

/* The curve at one parameter. */
struct curve_point {
    struct dvec3 position, tangent, top;
    double radius;
};

static double catmull_rom(double a, double b, double c, double d, double t)
{
    return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

static double catmull_rom_slope(double a, double b, double c, double d, double t)
{
    return 0.5 * (c - a + t * (2 * (2 * a - 5 * b + 4 * c - d) + t * 3 * (3 * (b - c) + d - a)));
}

/* `u` in knots, [0, knot_count - 1]. The ends are continued by themselves. */
static struct curve_point curve_at(const struct sweep *s, double u)
{
    unsigned last = s->knot_count - 1;
    unsigned i = u >= last ? last - 1 : (unsigned)u;
    double t = u - i, position[3], tangent[3], top[3];
    const struct sweep_knot *b = &s->knots[i], *c = b + 1, *a = i > 0 ? b - 1 : b, *d = i + 2 <= last ? c + 1 : c;
    for (int k = 0; k < 3; k++) {
        position[k] = catmull_rom(a->position[k], b->position[k], c->position[k], d->position[k], t);
        tangent[k] = catmull_rom_slope(a->position[k], b->position[k], c->position[k], d->position[k], t);
        top[k] = b->top[k] + (c->top[k] - b->top[k]) * t * t * (3 - 2 * t);
    }
    return (struct curve_point){
        dvec3(position[0], position[1], position[2]),
        dvec3_normalize(dvec3(tangent[0], tangent[1], tangent[2])),
        dvec3(top[0], top[1], top[2]),
        catmull_rom(a->radius, b->radius, c->radius, d->radius, t),
    };
}

/* lengths[i] = length up to parameter i / LENGTH_STEPS of the whole. */
static void measure(const struct sweep *s, double lengths[LENGTH_STEPS + 1])
{
    struct dvec3 before = curve_at(s, 0).position;
    lengths[0] = 0;
    for (unsigned i = 1; i <= LENGTH_STEPS; i++) {
        struct dvec3 here = curve_at(s, (double)i * (s->knot_count - 1) / LENGTH_STEPS).position;
        lengths[i] = lengths[i - 1] + dvec3_length(dvec3_sub(here, before));
        before = here;
    }
}

/* Where `length` is reached; `*from` remembers the place in the table between calls with growing lengths. */
static double parameter_at(const struct sweep *s, const double lengths[LENGTH_STEPS + 1], double length, unsigned *from)
{
    while (*from + 1 < LENGTH_STEPS && lengths[*from + 1] < length)
        (*from)++;
    double piece = lengths[*from + 1] - lengths[*from];
    double rest = piece > 0 ? (length - lengths[*from]) / piece : 0;
    return (*from + rest) * (s->knot_count - 1) / LENGTH_STEPS;
}

/* 0 at an end of the curve, 1 from `radius` inwards: half a ball. */
static double rounding(double distance, double radius)
{
    double x = distance >= radius ? 1 : distance / radius;
    return sqrt(x * (2 - x));
}

static void add_ring(struct mesh_builder *b, const struct sweep *s, const struct curve_point *at, struct sweep_place place,
                     unsigned sides)
{
    struct dvec3 side = dvec3_normalize(dvec3_cross(at->tangent, at->top)), top = dvec3_cross(side, at->tangent);
    for (unsigned k = 0; k < sides; k++) {
        place.angle = 2 * PI * k / sides;
        struct dvec3 out = dvec3_mad(dvec3_scale(top, cos(place.angle)), side, sin(place.angle));
        place.angle -= place.angle > PI ? 2 * PI : 0;
        place.position = dvec3_mad(at->position, out, place.radius);
        double push = s->displace ? s->displace(b, &place) : 0;
        mesh_builder_vertex(b, dvec3_mad(place.position, out, push), out);
    }
}

/* Angles run so that top, side, tangent are right-handed: rings are counter-clockwise seen against the tangent's way. */
static void connect(struct mesh_builder *b, uint32_t start, unsigned rings, unsigned sides)
{
    uint32_t first = start + 1, end = first + rings * sides, last = end - sides;
    for (unsigned k = 0; k < sides; k++)
        mesh_builder_triangle(b, start, first + (k + 1) % sides, first + k);
    for (unsigned i = 0; i + 1 < rings; i++)
        for (unsigned k = 0; k < sides; k++) {
            uint32_t here = first + i * sides + k, next = first + i * sides + (k + 1) % sides;
            mesh_builder_quad(b, here, next, next + sides, here + sides);
        }
    for (unsigned k = 0; k < sides; k++)
        mesh_builder_triangle(b, end, last + k, last + (k + 1) % sides);
}

void sweep_add(struct mesh_builder *b, const struct sweep *s, unsigned rings, unsigned sides)
{
    double lengths[LENGTH_STEPS + 1];
    measure(s, lengths);
    double length = lengths[LENGTH_STEPS];
    struct curve_point first = curve_at(s, 0), last = curve_at(s, s->knot_count - 1);
    uint32_t start = mesh_builder_vertex(b, first.position, dvec3_neg(first.tangent));
    for (unsigned i = 0, from = 0; i < rings; i++) {
        double along = length * (i + 0.5) / rings;
        struct curve_point at = curve_at(s, parameter_at(s, lengths, along, &from));
        double rounded = at.radius * rounding(along, first.radius) * rounding(length - along, last.radius);
        add_ring(b, s, &at, (struct sweep_place){.along = along, .length = length, .radius = rounded}, sides);
    }
    mesh_builder_vertex(b, last.position, last.tangent);
    connect(b, start, rings, sides);
}

void sweep_grid(uint32_t triangles, double slimness, unsigned *rings, unsigned *sides)
{
    double half = triangles / 2.0, ideal = sqrt(half / slimness);
    unsigned low = (unsigned)(0.85 * ideal), high = (unsigned)(1.18 * ideal) + 1;
    double best = INFINITY;
    for (unsigned s = low < 3 ? 3 : low; s <= (high < 3 ? 3 : high); s++) {
        double r = fmax(1, round(half / s));
        double miss = fabs(r * s - half) + 1e-3 * fabs(s - ideal);
        if (miss < best) {
            best = miss;
            *rings = (unsigned)r;
            *sides = s;
        }
    }
}

static double lattice(int x, int y, int z)
{
    return 2 * hash_unit((uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u ^ (uint32_t)z * 83492791u) - 1;
}

static double mix(double a, double b, double t) { return a + (b - a) * t; }

double noise3(struct dvec3 p)
{
    int x = (int)floor(p.x), y = (int)floor(p.y), z = (int)floor(p.z);
    double u = p.x - x, v = p.y - y, w = p.z - z;
    u = u * u * (3 - 2 * u);
    v = v * v * (3 - 2 * v);
    w = w * w * (3 - 2 * w);
    double near = mix(mix(lattice(x, y, z), lattice(x + 1, y, z), u), mix(lattice(x, y + 1, z), lattice(x + 1, y + 1, z), u), v);
    double far = mix(mix(lattice(x, y, z + 1), lattice(x + 1, y, z + 1), u),
                     mix(lattice(x, y + 1, z + 1), lattice(x + 1, y + 1, z + 1), u), v);
    return mix(near, far, w);
}
