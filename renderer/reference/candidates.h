/* Which triangles a line may cross: an Embree tree of user geometries, one primitive a drawn triangle, over boxes widened so far that no
 * rounding of Embree's fp32 traversal can lose one. The callbacks decide (lines.h).
 *
 * Margin. Let S = the largest |coordinate| of the scene plus its diagonal. Lines are clipped to the scene's box in double, then given to
 * Embree as an fp32 origin (off by at most 2^-24 S in each axis), a unit direction (2^-24 off, over at most the diagonal: 2^-24 S) and
 * slab tests whose distances carry a few roundings of 2^-24 each (difference, reciprocal, product: 5 x 2^-24 S taken as displacement; the
 * robust traversal widens its intervals by three of them again). Together below 2^-21 S; 2^-19 S is used. */
#pragma once

#include <embree3/rtcore.h>
#include <stdatomic.h>

#include "reference/reference.h"

/* What a callback needs to know of the instance it was called for. */
struct candidate_part {
    const struct reference *reference;
    uint32_t instance;
    uint32_t first_triangle;
    bool holes;
    int hidden; /* the sign of N . direction at which the camera does not see a triangle; 0: sees both sides */
};

struct reference {
    const struct scene *scene;
    RTCDevice device;
    RTCScene tree;
    struct candidate_part *parts; /* one an instance */
    struct dbox box;              /* of the scene, widened: lines are clipped to it */
    double scale, margin;         /* S, and how far boxes are widened */
    atomic_size_t embree_bytes;
};

/* Corners of `triangle` (0-based in the part); false when the triangle is to be ignored: some corner not finite or beyond 1e18. */
bool candidate_corners(const struct candidate_part *part, uint32_t triangle, struct dvec3 corners[3]);

/* The part that drawn-triangle `id` belongs to. */
const struct candidate_part *candidate_part_of(const struct reference *r, uint32_t id);

bool candidates_build(struct reference *r, unsigned threads);
void candidates_finish(struct reference *r);
