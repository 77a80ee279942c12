#include "list_reading.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "stage.h"

bool list_reading_take(struct stage *stage, unsigned light, struct list_reading *out, struct error *err)
{
    *out = (struct list_reading){0};
    if (!stage->settings.system->read_lists)
        return true;
    if (!renderer_read_lists(stage->uploaded, light, &out->lists, &out->fit, err))
        return err->code == ERROR_NONE;
    out->given = true;
    size_t count = out->fit.caster_count;
    out->casters = malloc((count + 1) * sizeof *out->casters);
    if (!out->casters)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for the lists of triangles");
    if (count)
        memcpy(out->casters, out->fit.casters, count * sizeof *out->casters);
    out->fit.casters = out->casters;
    return true;
}

static void drop_lists(struct list_reading *reading)
{
    free(reading->lists.first);
    free(reading->lists.triangles);
    reading->lists = (struct shadow_lists){0};
}

bool list_reading_measure(struct list_reading *reading, const struct tracer *tracer, struct job_pool *pool,
                          const struct reference_progress *progress)
{
    if (!reading->given)
        return true;
    const struct identified_input in = {.maps = reading->fit.maps,
                                        .map_count = reading->lists.map_count,
                                        .size = reading->lists.size,
                                        .first = reading->lists.first,
                                        .triangles = reading->lists.triangles,
                                        .casters = reading->fit.casters,
                                        .caster_count = reading->fit.caster_count};
    bool good = identified_measure(tracer, &in, pool, progress, &reading->result);
    drop_lists(reading);
    return good;
}

void list_reading_finish(struct list_reading *reading)
{
    drop_lists(reading);
    free(reading->casters);
    reading->fit = (struct shadow_fit){0};
    reading->casters = NULL;
}
