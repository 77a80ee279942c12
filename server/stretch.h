/* A stretch of a whole progress bar, as a bar of its own. */
#pragma once

#include <stdbool.h>

#include "reference/reference.h"

struct stretch {
    const struct reference_progress *progress; /* of the whole; may be NULL */
    double from, share;                        /* of 1 */
};

/* `context`: the struct stretch. For struct reference_progress. */
bool stretch_report(void *context, double done);
