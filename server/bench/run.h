/* Runs a plan: scene by scene, batch by batch, the cells of a batch in turns. */
#pragma once

#include <stdbool.h>

#include "report.h"

struct common_options;
struct error;
struct interruption;
struct progress;

/* Fills in report->plan and what is known of the machine. What fails in one cell is kept there and the run goes on; false only where nothing
 * can be run at all (no device, no memory). An interruption ends it early with report->interrupted set. On the calling thread. */
bool bench_run(struct bench_report *report, const struct common_options *common, struct interruption *interruption,
               struct progress *progress, struct error *err);
