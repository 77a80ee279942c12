/* How many of the triangles that a light sees in a texel a system's list of that texel holds (the claim of coverage-li-2017, "over 90 %").
 *
 * A texel's *seen* triangles are those that 16 x 16 rays, through the centres of its subcells, meet first among the casters. Texels are
 * drawn without replacement over all maps of the light, in an order that a fixed seed gives, until IDENTIFIED_TEXELS with at least two seen
 * triangles were measured, or IDENTIFIED_DRAWS were drawn, or there are no more. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "reference/reference.h"
#include "scene/view.h"

struct tracer;

enum { IDENTIFIED_TEXELS = 20000, IDENTIFIED_DRAWS = 1000000, IDENTIFIED_SIDE = 16, IDENTIFIED_ORACLE = 5 };

/* Lists as struct shadow_lists has them. */
struct identified_input {
    const struct view *maps;
    unsigned map_count;
    uint32_t size;
    const uint32_t *first, *triangles;
    const uint32_t *casters; /* NULL: every instance */
    size_t caster_count;
};

/* Sums, so that lights add up. "oracle": a list of the IDENTIFIED_ORACLE most visible triangles in place of the system's. */
struct identified {
    uint64_t texels, texels_over_4; /* measured; of those, with more than four seen */
    uint64_t seen, found, found_by_oracle;
    double fractions, oracle_fractions; /* sums over texels of found / seen */
};

/* False when stopped early or memory is out. */
bool identified_measure(const struct tracer *tracer, const struct identified_input *in, struct job_pool *pool,
                        const struct reference_progress *progress, struct identified *out);
void identified_add(struct identified *sum, const struct identified *more);
