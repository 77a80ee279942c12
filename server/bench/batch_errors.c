#include <stdio.h>

#include "against.h"
#include "base/error.h"
#include "batch.h"
#include "comparison.h"
#include "interruption.h"
#include "stage.h"

static const struct against references[BENCH_REFERENCES] = {{.kind = AGAINST_POINT}, {.kind = AGAINST_SAMPLES32}};
static const unsigned measure_of[BENCH_REFERENCES] = {MEASURE_POINT, MEASURE_SAMPLES32};

static bool go_on(void *context, double done)
{
    (void)done;
    return !interruption_came(context);
}

static void compare_cell(struct bench_batch *batch, struct bench_cell *cell, int reference)
{
    struct error err = {0};
    struct comparison c = {0};
    const struct reference_progress report = {go_on, batch->interruption};
    batch->stage->settings.system = cell->system;
    batch->stage->settings.params = cell->params;
    cell->started = true;
    if (comparison_render(batch->stage, &references[reference], &c, &err) &&
        comparison_trace(batch->stage, &references[reference], &report, &c, &err))
        cell->errors[reference] = (struct bench_errors){.measured = true, .m = c.total};
    else if (!interruption_came(batch->interruption))
        snprintf(cell->failed, sizeof cell->failed, "%s", err.message);
    comparison_finish(&c);
}

bool batch_compare(struct bench_batch *batch)
{
    for (int reference = 0; reference < BENCH_REFERENCES; reference++)
        for (size_t i = 0; i < batch->count; i++) {
            struct bench_cell *cell = &batch->cells[i];
            if (interruption_came(batch->interruption))
                return false;
            if (cell->measures & measure_of[reference] && !cell->failed[0])
                compare_cell(batch, cell, reference);
        }
    return true;
}
