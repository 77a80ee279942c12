/* A texel in sixteen bytes (papers/coverage-li-2017, figure 4), and what is left of a triangle in them.
 *
 * Ours: six coordinates of 14 bits (sign, 5 exponent, 8 mantissa; in texels from the texel's centre), conservative minimum depth 16 bits, two slopes of
 * 8 bits (sign, 4 exponent, 3 mantissa) for the normal, four links of 3 bits to neighbours. The paper gives coordinates 16 bits, which leaves
 * 16 for normal, id and links together: no room for slopes that eq. 4 could use. There is no id: a triangle is known by its coordinates.
 * A packed texel is made when it is read, from the map; nothing is kept. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "shadow/geometry/geometry_maps.h"

/* Longest list that the links allow, the texel's own triangle included. */
enum { COVERAGE_PACKED_NODES = 4 };

/* What the triangle says that texel (x, y) keeps, `at` in the map, as sixteen bytes tell it: inside by packed coordinates, depth by eq. 4
 * with c at the texel's centre and z~ the texel's minimum. */
enum geometry_verdict coverage_packed_ask(const struct geometry_map *m, uint32_t x, uint32_t y, size_t at,
                                          const struct map_point *p, uint32_t *hint);

/* `value` rounded to a float of `exponent` and `mantissa` bits, exponent bias `bias`; too small becomes 0, too large the largest. */
float coverage_packed_round(float value, int exponent, int mantissa, int bias);
