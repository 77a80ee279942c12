#include "findings.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "goals.h"
#include "models.h"
#include "series.h"

enum { GOALS_MAX = 64, SETUPS_MAX = 256, GLANCES_MAX = 32 };

static void say(struct bench_findings *f, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void say(struct bench_findings *f, const char *format, ...)
{
    char *sentence = NULL;
    va_list arguments;
    va_start(arguments, format);
    int n = vasprintf(&sentence, format, arguments);
    va_end(arguments);
    if (n >= 0 && !array_push(&f->sentences, sentence))
        free(sentence);
}

void bench_findings_finish(struct bench_findings *f)
{
    for (size_t i = 0; i < f->sentences.count; i++)
        free(f->sentences.data[i]);
    array_finish(&f->sentences);
}

static double median_ms(const struct bench_cell *c, int regime)
{
    const struct bench_times *t = &c->times[regime];
    return t->measured ? series_of(t->frame_ms, t->rounds).median : NAN;
}

/* The cheapest with no pixel misclassified; how many were timed. */
static const struct bench_cell *find_cheapest_right(const struct bench_plan *plan, size_t setup, int regime, size_t *timed)
{
    const struct bench_cell *cheapest = NULL;
    *timed = 0;
    for (size_t i = 0; i < plan->cells.count; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        const struct bench_errors *e = &c->errors[AGAINST_POINT_INDEX];
        if (c->setup != setup || !e->measured || !c->times[regime].measured)
            continue;
        ++*timed;
        if (e->m.misclassified == 0 && (!cheapest || median_ms(c, regime) < median_ms(cheapest, regime)))
            cheapest = c;
    }
    return cheapest;
}

enum { TIMED_MIN = 3 }; /* fewer are no choice */

static void say_cheapest(struct bench_findings *f, const struct bench_plan *plan, size_t setup)
{
    size_t timed, timed_moving;
    const struct bench_cell *still = find_cheapest_right(plan, setup, REGIME_STILL, &timed),
                            *moving = find_cheapest_right(plan, setup, REGIME_MOVING, &timed_moving);
    const char *scene = model_label(plan->setups.data[setup].scene);
    if (timed < TIMED_MIN || timed_moving < TIMED_MIN)
        return;
    if (!still || !moving)
        say(f, "%s: none of the %zu is without a wrong pixel.", scene, timed);
    else if (still == moving)
        say(f, "%s: the cheapest without a wrong pixel is %s, %.1f ms a frame with the light still and %.1f moving.", scene,
            still->name, median_ms(still, REGIME_STILL), median_ms(still, REGIME_MOVING));
    else
        say(f, "%s: the cheapest without a wrong pixel are %s with the light still, %.1f ms a frame, and %s moving, %.1f ms.",
            scene, still->name, median_ms(still, REGIME_STILL), moving->name, median_ms(moving, REGIME_MOVING));
}

/* Systems that are cheaper than the baseline and no worse, or better and no dearer than a tenth, by their medians. */
static void say_glances(struct bench_findings *f, const struct bench_plan *plan)
{
    struct bench_glance g[GLANCES_MAX];
    size_t count = bench_glances(plan, g, GLANCES_MAX);
    for (size_t i = 0; i < count; i++) {
        if (!(g[i].error_ratio > 0 && g[i].error_ratio < 1))
            continue;
        say(f,
            "%s has %.2g times the wrong pixels of %s at its best, for %.2f times its frame with the light still and %.2f times moving (medians of %zu scenes).",
            g[i].system->name, g[i].error_ratio, g[i].baseline, g[i].still_ratio, g[i].moving_ratio, g[i].setups);
    }
}

static void say_goals(struct bench_findings *f, const struct bench_plan *plan)
{
    struct goal_result results[GOALS_MAX];
    size_t count = bench_goals_check(plan, results, GOALS_MAX), met = 0;
    for (size_t i = 0; i < count; i++)
        met += results[i].met;
    if (count)
        say(f, "Of %zu goals that could be checked %zu are met.", count, met);
}

static bool is_plain_cell(const struct bench_cell *c)
{
    struct shadow_params d = shadow_defaults(c->system);
    return !memcmp(d.value, c->params.value, c->system->param_count * sizeof d.value[0]);
}

static void say_failures(struct bench_findings *f, const struct bench_plan *plan)
{
    size_t failed = 0, missing = 0;
    for (size_t i = 0; i < plan->cells.count; i++) {
        failed += plan->cells.data[i].failed[0] != 0;
        missing += !plan->cells.data[i].started && !plan->cells.data[i].failed[0];
    }
    if (failed)
        say(f, "%zu of %zu cells failed; their rows say why.", failed, plan->cells.count);
    if (missing)
        say(f, "The run was ended early: %zu of %zu cells are missing.", missing, plan->cells.count);
}

/* Of the hard cases: how many each system gets right, and where it is worst. */
static void say_hard(struct bench_findings *f, const struct bench_plan *plan, unsigned table)
{
    for (size_t s = 0; s < shadow_system_count; s++) {
        const struct bench_cell *worst = NULL;
        size_t cases = 0, right = 0;
        for (size_t i = 0; i < plan->cells.count; i++) {
            const struct bench_cell *c = &plan->cells.data[i];
            const struct bench_errors *e = &c->errors[AGAINST_POINT_INDEX];
            if (!(c->tables & 1u << table) || c->system != shadow_systems[s] || !is_plain_cell(c) || !e->measured)
                continue;
            cases++;
            right += e->m.misclassified == 0;
            if (!worst || e->m.misclassified_fraction > worst->errors[AGAINST_POINT_INDEX].m.misclassified_fraction)
                worst = c;
        }
        if (cases && right == cases)
            say(f, "%s: %s gets every pixel of all %zu right.", plan->suite->tables[table]->title, shadow_systems[s]->name,
                cases);
        else if (cases)
            say(f, "%s: %s is right on %zu of %zu; worst on %s, with %.2g %% of the pixels wrong.",
                plan->suite->tables[table]->title, shadow_systems[s]->name, right, cases,
                model_label(plan->setups.data[worst->setup].scene),
                100 * worst->errors[AGAINST_POINT_INDEX].m.misclassified_fraction);
    }
}

/* Setups that only scaling tables show would weigh too much. */
static bool shown_in_rows(const struct bench_plan *plan, size_t setup)
{
    if (plan->setups.data[setup].lights || plan->setups.data[setup].width != plan->width)
        return false;
    for (size_t i = 0; i < plan->cells.count; i++)
        for (unsigned t = 0; plan->suite->tables[t]; t++)
            if (plan->cells.data[i].setup == setup && plan->cells.data[i].tables & 1u << t &&
                plan->suite->tables[t]->shape == SHAPE_ROWS)
                return true;
    return false;
}

void bench_findings_make(const struct bench_plan *plan, struct bench_findings *out)
{
    *out = (struct bench_findings){0};
    say_failures(out, plan);
    say_goals(out, plan);
    say_glances(out, plan);
    for (size_t s = 0; s < plan->setups.count; s++)
        if (shown_in_rows(plan, s))
            say_cheapest(out, plan, s);
    for (unsigned t = 0; plan->suite->tables[t]; t++)
        if (plan->suite->tables[t]->shape == SHAPE_MATRIX)
            say_hard(out, plan, t);
}

/* What is gathered of one system. */
struct gathering {
    double still[SETUPS_MAX], moving[SETUPS_MAX], error[SETUPS_MAX], fraction[SETUPS_MAX], rmse32[SETUPS_MAX], mib[SETUPS_MAX];
    size_t count;
};

static double ratio_to(const struct bench_cell *c, const struct bench_cell *base, int regime)
{
    const struct bench_times *t = &c->times[regime], *b = &base->times[regime];
    return t->measured && b->measured && t->rounds == b->rounds ? series_of_ratios(t->frame_ms, b->frame_ms, t->rounds).median
                                                                : NAN;
}

static void gather(struct gathering *g, const struct bench_plan *plan, const struct bench_cell *c, const char *baseline)
{
    const struct bench_errors *point = &c->errors[AGAINST_POINT_INDEX], *full = &c->errors[AGAINST_SAMPLES32_INDEX];
    const struct bench_cell *base = bench_baseline(plan, c, baseline);
    int64_t best = bench_best_misclassified(plan, c, baseline);
    size_t i = g->count++;
    g->still[i] = base ? ratio_to(c, base, REGIME_STILL) : strcmp(c->system->name, baseline) ? NAN : 1;
    g->moving[i] = base ? ratio_to(c, base, REGIME_MOVING) : strcmp(c->system->name, baseline) ? NAN : 1;
    g->error[i] = point->measured && best > 0 ? (double)point->m.misclassified / (double)best : NAN;
    g->fraction[i] = point->measured ? point->m.misclassified_fraction : NAN;
    g->rmse32[i] = full->measured ? full->m.rmse : NAN;
    g->mib[i] = (double)c->shadow_bytes / (1 << 20);
}

static void gather_system(struct gathering *g, const struct bench_plan *plan, const struct shadow_system *system,
                          const char **baseline)
{
    g->count = 0;
    for (size_t i = 0; i < plan->cells.count && g->count < SETUPS_MAX; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        const char *name = bench_cell_baseline_name(plan, c);
        if (c->system != system || !name || !is_plain_cell(c) || !shown_in_rows(plan, c->setup) ||
            !c->times[REGIME_STILL].measured)
            continue;
        *baseline = name;
        gather(g, plan, c, name);
    }
}

size_t bench_glances(const struct bench_plan *plan, struct bench_glance *out, size_t max)
{
    struct gathering *g = malloc(sizeof *g);
    size_t count = 0;
    for (size_t s = 0; g && s < shadow_system_count && count < max; s++) {
        const char *baseline = NULL;
        gather_system(g, plan, shadow_systems[s], &baseline);
        if (!g->count)
            continue;
        out[count++] = (struct bench_glance){
            .system = shadow_systems[s],
            .baseline = baseline,
            .setups = g->count,
            .still_ratio = series_of(g->still, g->count).median,
            .moving_ratio = series_of(g->moving, g->count).median,
            .error_ratio = series_of(g->error, g->count).median,
            .fraction = series_of(g->fraction, g->count).median,
            .rmse32 = series_of(g->rmse32, g->count).median,
            .mib = series_of(g->mib, g->count).median,
        };
    }
    free(g);
    return count;
}
