/* What the best lists could do: shadows from a list, in each texel of the light's maps, of the triangles most visible there, each tested in
 * double at the receiver's own point, and one depth: where the texel is wholly covered, whatever lies deeper than all that its rays met is
 * shadowed. What a system with such lists loses beyond this, it loses by its choice; one that reads the neighbours' lists too, or recovers
 * triangles otherwise, may do better. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "reference/reference.h"
#include "scene/view.h"

struct tracer;

enum { ORACLE_LENGTH_MAX = 64, ORACLE_SIDE = 16 };

struct oracle_input {
    const struct view *maps; /* square, width texels a side */
    unsigned map_count;
    const uint32_t *casters; /* NULL: every instance */
    size_t caster_count;
    unsigned length;         /* of a list, 1..ORACLE_LENGTH_MAX; visibility is counted with ORACLE_SIDE^2 rays a texel */
    const struct view *view; /* the camera; ids and receiver as reference_point() has them */
    const struct light *light;
    const uint32_t *ids;
    const uint8_t *receiver;
};

/* visibility: 1 lit, 0 shadowed or no receiver; outside the maps lit. False when stopped early or memory is out. */
bool oracle_visibility(const struct scene *scene, const struct tracer *tracer, const struct oracle_input *in,
                       struct job_pool *pool, const struct reference_progress *progress, float *visibility);
