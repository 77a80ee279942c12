/* A closed surface swept along a curve: rings of vertices around a Catmull-Rom spline through control points, closed by one
 * vertex at either end, each vertex pushed outwards by a function of where it lies. */
#pragma once

#include <stdint.h>

#include "builtin/mesh_builder.h"

struct sweep_knot {
    double position[3];
    double radius;
    double top[3]; /* roughly, the direction of angle 0; need not be perpendicular to the curve, may not lie along it */
};

/* A place on the surface before it is displaced. */
struct sweep_place {
    double along;  /* length of curve behind it */
    double length; /* of the whole curve */
    double angle;  /* from the top, (-pi, pi] */
    double radius; /* there; already rounded off towards the ends */
    struct dvec3 position;
};

struct sweep {
    const struct sweep_knot *knots;
    unsigned knot_count; /* >= 2 */
    /* Added to the radius; may set the vertex colour. NULL: none. */
    double (*displace)(struct mesh_builder *b, const struct sweep_place *place);
};

/* Adds to the mesh being made. 2 * sides * rings triangles; sides >= 3, rings >= 1. Normals are left to mesh_builder_smooth(). */
void sweep_add(struct mesh_builder *b, const struct sweep *sweep, unsigned rings, unsigned sides);

/* Rings and sides for about `triangles` of them, squarish ones for a surface `slimness` times as long as it is around. */
void sweep_grid(uint32_t triangles, double slimness, unsigned *rings, unsigned *sides);

/* Smooth noise with features of size 1, [-1, 1]. */
double noise3(struct dvec3 p);
