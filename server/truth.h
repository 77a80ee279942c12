/* What a comparison holds a picture against: the reference's rays, and what is counted with rays. Any thread. */
#pragma once

#include <stdbool.h>

#include "against.h"
#include "reference/reference.h"

struct comparison;
struct stage;

/* Fills in truth, receiver, truth_masks, one_triangle, counts, reference_ms and the lists' figures of what comparison_render() left. */
bool truth_trace(const struct stage *stage, const struct against *against, const struct reference_progress *progress,
                 struct comparison *c, struct error *err);
/* The lists' figures alone. */
bool truth_count_lists(const struct stage *stage, struct comparison *c, struct error *err);
