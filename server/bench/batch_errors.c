#include <stdio.h>

#include "against.h"
#include "base/error.h"
#include "batch.h"
#include "comparison.h"
#include "interruption.h"
#include "stage.h"

static const unsigned measure_of[BENCH_REFERENCES] = {MEASURE_POINT, MEASURE_SAMPLES32, MEASURE_AREALIGHT};

static bool go_on(void *context, double done)
{
    (void)done;
    return !interruption_came(context);
}

void bench_truths_finish(struct bench_truth truths[BENCH_REFERENCES])
{
    for (int i = 0; i < BENCH_REFERENCES; i++) {
        comparison_finish(&truths[i].comparison);
        truths[i] = (struct bench_truth){0};
    }
}

static bool compare(struct bench_batch *batch, int reference, struct error *err)
{
    struct bench_truth *truth = &batch->truths[reference];
    const struct reference_progress report = {go_on, batch->interruption};
    if (truth->traced)
        return comparison_repeat(batch->stage, &truth->against, &truth->comparison, err);
    comparison_finish(&truth->comparison);
    truth->traced = against_parse(bench_reference_names[reference], &truth->against, err) &&
                    comparison_render(batch->stage, &truth->against, &truth->comparison, err) &&
                    comparison_trace(batch->stage, &truth->against, &report, &truth->comparison, err);
    return truth->traced;
}

static void keep_lists(const struct comparison *c, struct bench_cell *cell)
{
    for (size_t i = 0; i < c->light_count; i++) {
        cell->has_lists |= c->lists[i].given;
        identified_add(&cell->lists, &c->lists[i].result);
    }
}

static void compare_cell(struct bench_batch *batch, struct bench_cell *cell, int reference)
{
    struct error err = {0};
    const struct comparison *c = &batch->truths[reference].comparison;
    batch->stage->settings.system = cell->system;
    batch->stage->settings.params = cell->params;
    cell->started = true;
    if (compare(batch, reference, &err)) {
        cell->errors[reference] = (struct bench_errors){.measured = true, .m = c->total};
        if (reference == AGAINST_POINT_INDEX)
            keep_lists(c, cell);
        if (reference == AGAINST_POINT_INDEX && cell->figures)
            bench_shots_take(batch->shots, cell, c);
    } else if (!interruption_came(batch->interruption)) {
        snprintf(cell->failed, sizeof cell->failed, "%s", err.message);
    }
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
