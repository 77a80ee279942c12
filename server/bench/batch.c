#include "batch.h"

/* Of a cell's time, roughly. */
static const double ERROR_SHARE = 0.4;

void batch_advance(const struct bench_batch *batch, const struct bench_cell *cell, double share)
{
    if (batch->pace.advance)
        batch->pace.advance(batch->pace.context, share * bench_cell_seconds(batch->plan, cell));
}

bool batch_run(struct bench_batch *batch)
{
    if (!batch_time(batch))
        return false;
    for (size_t i = 0; i < batch->count; i++)
        batch_advance(batch, &batch->cells[i], 1 - ERROR_SHARE);
    if (!batch_compare(batch))
        return false;
    for (size_t i = 0; i < batch->count; i++)
        batch_advance(batch, &batch->cells[i], ERROR_SHARE);
    return true;
}
