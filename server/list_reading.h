/* A system's triangle lists for one light, taken off the device and held against what the light sees: the figures identified_*. */
#pragma once

#include <stdbool.h>

#include "reference/identified.h"
#include "renderer.h"

struct stage;
struct tracer;

/* Everything is owned. */
struct list_reading {
    bool given; /* the system has lists */
    struct shadow_lists lists;
    struct shadow_fit fit; /* its casters are a copy */
    uint32_t *casters;
    struct identified result; /* of list_reading_measure() */
};

/* Of the stage's last frame, on the renderer's thread. True with `given` unset where the system has no lists. The caller finishes `out`,
 * whatever this returns. */
bool list_reading_take(struct stage *stage, unsigned light, struct list_reading *out, struct error *err);
/* Any thread. Frees the lists themselves. False when stopped early or memory is out. */
bool list_reading_measure(struct list_reading *reading, const struct tracer *tracer, struct job_pool *pool,
                          const struct reference_progress *progress);
/* `given` and `result` stay. */
void list_reading_finish(struct list_reading *reading);
