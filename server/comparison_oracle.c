#include <stdlib.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "comparison.h"
#include "reference/oracle.h"
#include "stage.h"
#include "stretch.h"
#include "trace/tracer.h"

/* One light's share: what such lists would have made of it, in place of what was tested. */
static bool add_oracle(const struct stage *stage, const struct tracer *tracer, const struct comparison *c, size_t light,
                       unsigned length, const struct reference_progress *progress, float *visibility, struct metrics_pool *pool)
{
    struct metrics m;
    const struct list_reading *lists = &c->lists[light];
    const struct view view = view_from_camera(&stage->settings.camera, c->width, c->height);
    const struct oracle_input in = {.maps = lists->fit.maps,
                                    .map_count = lists->fit.map_count,
                                    .casters = lists->fit.casters,
                                    .caster_count = lists->fit.caster_count,
                                    .length = length,
                                    .view = &view,
                                    .light = &stage->settings.lights[light],
                                    .ids = c->ids,
                                    .receiver = c->receiver[light]};
    const struct metrics_input measured = {.width = c->width,
                                           .height = c->height,
                                           .visibility = visibility,
                                           .reference = c->truth[light],
                                           .receiver = c->receiver[light],
                                           .one_triangle = c->one_triangle,
                                           .wrong_samples = -1};
    return oracle_visibility(stage->scene, tracer, &in, stage->pool, progress, visibility) &&
           metrics_pool_add(pool, &measured, &m);
}

bool comparison_oracle(const struct stage *stage, unsigned length, const struct reference_progress *progress,
                       const struct comparison *c, struct metrics *out, struct error *err)
{
    struct metrics_pool pool;
    float *visibility = malloc((size_t)c->width * c->height * sizeof *visibility);
    struct tracer *tracer = visibility ? tracer_create(stage->scene, job_pool_threads(stage->pool), err) : NULL;
    bool good = tracer != NULL;
    metrics_pool_init(&pool);
    for (size_t i = 0; good && i < c->light_count; i++) {
        struct stretch stretch = {progress, (double)i / (double)c->light_count, 1.0 / (double)c->light_count};
        const struct reference_progress report = {stretch_report, &stretch};
        good = !c->lists[i].given || add_oracle(stage, tracer, c, i, length, &report, visibility, &pool);
    }
    *out = pool.total;
    metrics_pool_finish(&pool);
    tracer_destroy(tracer);
    free(visibility);
    return good || error_set(err, ERROR_TRY_AGAIN, NULL, "the oracle was stopped early, or memory is out for it");
}
