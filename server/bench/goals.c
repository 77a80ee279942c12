#include "goals.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "models.h"
#include "series.h"

/* The cell that an algorithm of a goal means in one setup; NULL: not there. */
static const struct bench_cell *find_cell(const struct bench_plan *plan, size_t setup, const char *algorithm)
{
    const struct shadow_system *system;
    struct shadow_params params;
    struct error err = {0};
    if (!algorithm || !shadow_parse(algorithm, &system, &params, &err))
        return NULL;
    for (size_t i = 0; i < plan->cells.count; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        if (c->setup == setup && c->system == system &&
            !memcmp(c->params.value, params.value, system->param_count * sizeof params.value[0]))
            return c;
    }
    return NULL;
}

static double times_ratio(const struct bench_cell *a, const struct bench_cell *b, int regime)
{
    const struct bench_times *s = &a->times[regime], *o = &b->times[regime];
    if (!s->measured || !o->measured)
        return NAN;
    /* Of one batch, so round by round; of two, medians have to do. */
    if (s->rounds == o->rounds && a->map_size == b->map_size)
        return series_of_ratios(s->frame_ms, o->frame_ms, s->rounds).median;
    return series_of(s->frame_ms, s->rounds).median / series_of(o->frame_ms, o->rounds).median;
}

static double visibility_ms(const struct bench_cell *c, int regime)
{
    const struct bench_times *t = &c->times[regime];
    return t->passes_measured ? t->pass_ms[PASS_RECEIVERS] + t->pass_ms[PASS_PREPARE] + t->pass_ms[PASS_RESOLVE] : NAN;
}

static double error_ratio(const struct bench_plan *plan, const struct bench_cell *subject, const char *object)
{
    const struct bench_errors *e = &subject->errors[AGAINST_POINT_INDEX];
    int64_t best = bench_best_misclassified(plan, subject, object);
    return e->measured && best > 0 ? (double)e->m.misclassified / (double)best : NAN;
}

static double wrong_samples(const struct bench_cell *c)
{
    const struct bench_errors *e = &c->errors[AGAINST_SAMPLES32_INDEX];
    return e->measured && e->m.wrong_samples >= 0 ? (double)e->m.wrong_samples : NAN;
}

static double value_of(const struct bench_plan *plan, const struct bench_goal *goal, size_t setup)
{
    const struct bench_cell *subject = find_cell(plan, setup, goal->subject), *object = find_cell(plan, setup, goal->object);
    if (!subject || (!object && goal->kind != GOAL_ERROR_RATIO && goal->kind != GOAL_WRONG_SAMPLES))
        return NAN;
    switch (goal->kind) {
    case GOAL_ERROR_RATIO: return error_ratio(plan, subject, goal->object);
    case GOAL_MOVING_RATIO: return times_ratio(subject, object, REGIME_MOVING);
    case GOAL_STILL_RATIO: return times_ratio(subject, object, REGIME_STILL);
    case GOAL_WRONG_SAMPLES: return wrong_samples(subject);
    case GOAL_VISIBILITY_GAIN: return visibility_ms(object, REGIME_STILL) / visibility_ms(subject, REGIME_STILL);
    case GOAL_VISIBILITY_GAIN_MOVING: return visibility_ms(object, REGIME_MOVING) / visibility_ms(subject, REGIME_MOVING);
    }
    return NAN;
}

static bool at_least(const struct bench_goal *goal)
{
    return goal->kind == GOAL_VISIBILITY_GAIN || goal->kind == GOAL_VISIBILITY_GAIN_MOVING;
}

static const char *const what[] = {
    [GOAL_ERROR_RATIO] = "misclassified pixels of %s over the best of %s",
    [GOAL_MOVING_RATIO] = "frame of %s over %s, light moving",
    [GOAL_STILL_RATIO] = "frame of %s over %s, light still",
    [GOAL_WRONG_SAMPLES] = "samples of %s that are wrong",
    [GOAL_VISIBILITY_GAIN] = "visibility by %s faster than by %s, light still",
    [GOAL_VISIBILITY_GAIN_MOVING] = "visibility by %s faster than by %s, light moving",
};

static void describe(struct goal_result *r)
{
    char subject[300];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    snprintf(subject, sizeof subject, what[r->goal->kind], r->goal->subject, r->goal->object);
#pragma GCC diagnostic pop
    snprintf(r->sentence, sizeof r->sentence, "%s: %s", model_label(r->setup->scene), subject);
}

size_t bench_goals_check(const struct bench_plan *plan, struct goal_result *out, size_t max)
{
    size_t count = 0;
    for (const struct bench_goal *g = plan->suite->goals; g && g->subject; g++)
        for (size_t s = 0; s < plan->setups.count && count < max; s++) {
            const struct bench_setup *setup = &plan->setups.data[s];
            double value = value_of(plan, g, s);
            bool meant = setup->lights == 0 && setup->width == plan->width && setup->height == plan->height;
            if (!meant || isnan(value) || (g->scene && !model_is(g->scene, setup->scene)))
                continue;
            out[count] = (struct goal_result){
                .goal = g, .setup = setup, .value = value, .met = at_least(g) ? value >= g->bound : value <= g->bound};
            describe(&out[count++]);
        }
    return count;
}
