/* The suite's goals held against what was measured. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "plan.h"

struct goal_result {
    const struct bench_goal *goal;
    const struct bench_setup *setup;
    double value; /* in the goal's own terms */
    bool met;
    char sentence[400];
};

/* One for each goal whose cells were both measured, at most `max`; returns how many. */
size_t bench_goals_check(const struct bench_plan *plan, struct goal_result *out, size_t max);
