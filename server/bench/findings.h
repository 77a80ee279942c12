/* What a run says, in sentences that are computed from it and nothing else. */
#pragma once

#include "base/array.h"
#include "plan.h"

struct bench_findings {
    ARRAY(char *) sentences; /* owned */
};

/* One system over all scenes, at its defaults: medians over the setups in which it and the baseline were measured. NAN: nowhere. */
struct bench_glance {
    const struct shadow_system *system;
    const char *baseline;
    size_t setups;
    double still_ratio, moving_ratio; /* of frame times to the baseline's */
    double error_ratio;               /* of misclassified pixels to the baseline's best */
    double fraction;                  /* misclassified */
    double rmse32;                    /* against samples32 */
    double mib;
};

void bench_findings_make(const struct bench_plan *plan, struct bench_findings *out);
void bench_findings_finish(struct bench_findings *f);

/* A row for each system that has any; at most `max`. */
size_t bench_glances(const struct bench_plan *plan, struct bench_glance *out, size_t max);
