#include <math.h>
#include <string.h>

#include "findings.h"
#include "goals.h"
#include "models.h"
#include "series.h"
#include "write.h"

/* A column's cell; "-" where it was not measured. */
static void put_number(FILE *out, int width, const char *format, double value, bool measured)
{
    char text[40] = "-";
    if (measured && isfinite(value))
        snprintf(text, sizeof text, format, value);
    fprintf(out, " %*s", width, text);
}

static void put_times(FILE *out, const struct bench_times *t, const struct bench_times *base)
{
    struct series s = series_of(t->frame_ms, t->measured ? t->rounds : 0);
    bool both = base && base->measured && t->measured && base->rounds == t->rounds;
    put_number(out, 8, "%.2f", s.median, t->measured);
    put_number(out, 7, "%.2f", s.q3 - s.q1, t->measured);
    put_number(out, 6, "%.2f", both ? series_of_ratios(t->frame_ms, base->frame_ms, t->rounds).median : NAN, both);
}

static void put_errors(FILE *out, const struct bench_cell *cell)
{
    const struct bench_errors *point = &cell->errors[AGAINST_POINT_INDEX], *full = &cell->errors[AGAINST_SAMPLES32_INDEX];
    put_number(out, 8, "%.0f", (double)point->m.misclassified, point->measured);
    put_number(out, 9, "%.6f", point->m.misclassified_fraction, point->measured);
    put_number(out, 6, "%.0f", (double)point->m.leaks, point->measured);
    put_number(out, 6, "%.0f", (double)point->m.acne, point->measured);
    put_number(out, 7, "%.1f", point->m.boundary.edge_shift_p95, point->measured);
    put_number(out, 7, "%.4f", full->m.rmse, full->measured);
    put_number(out, 8, "%.0f", (double)full->m.wrong_samples, full->measured && full->m.wrong_samples >= 0);
}

static void put_row(FILE *out, const struct bench_plan *plan, const struct bench_table *table, const struct bench_cell *cell)
{
    const struct bench_cell *base = bench_baseline(plan, cell, table->baseline);
    fprintf(out, "  %-34.34s", cell->name);
    for (int r = 0; r < REGIME_COUNT; r++)
        put_times(out, &cell->times[r], base ? &base->times[r] : NULL);
    put_errors(out, cell);
    put_number(out, 7, "%.1f", (double)cell->shadow_bytes / (1 << 20), cell->times[0].measured || cell->times[1].measured);
    put_number(out, 6, "%.4f", bench_identified_fraction(cell), true);
    fputc('\n', out);
    if (cell->failed[0])
        fprintf(out, "      %s\n", cell->failed);
}

static void put_setup(FILE *out, const struct bench_setup *setup)
{
    fprintf(out, "\n%s, %ux%u, %zu triangles drawn", model_label(setup->scene), setup->width, setup->height,
            setup->drawn_triangles);
    if (setup->lights)
        fprintf(out, ", %u light%s", setup->lights, setup->lights == 1 ? "" : "s");
    fprintf(out, "\n  %-34s %8s %7s %6s %8s %7s %6s %8s %9s %6s %6s %7s %7s %8s %7s %6s\n", "", "still ms", "spread", "ratio",
            "moving", "spread", "ratio", "wrong", "fraction", "leaks", "acne", "edge95", "rmse32", "samples", "MiB", "lists");
}

static void put_rows(FILE *out, const struct bench_plan *plan, unsigned index)
{
    const struct bench_table *table = plan->suite->tables[index];
    size_t last = SIZE_MAX;
    for (size_t i = 0; i < plan->cells.count; i++) {
        const struct bench_cell *cell = &plan->cells.data[i];
        if (!(cell->tables & 1u << index) || (!cell->started && !cell->failed[0]))
            continue;
        if (cell->setup != last)
            put_setup(out, &plan->setups.data[cell->setup]);
        last = cell->setup;
        put_row(out, plan, table, cell);
    }
}

static void put_matrix_cell(FILE *out, const struct bench_cell *cell)
{
    const struct bench_errors *e = &cell->errors[AGAINST_POINT_INDEX], *full = &cell->errors[AGAINST_SAMPLES32_INDEX];
    char text[60] = "-";
    if (cell->failed[0])
        snprintf(text, sizeof text, "failed");
    else if (e->measured)
        snprintf(text, sizeof text, "%llu/%llu/%llu", (unsigned long long)e->m.misclassified, (unsigned long long)e->m.leaks,
                 (unsigned long long)e->m.acne);
    if (full->measured && full->m.wrong_samples >= 0)
        snprintf(text + strlen(text), sizeof text - strlen(text), " %lld", (long long)full->m.wrong_samples);
    fprintf(out, "  %-28.28s %s\n", cell->name, text);
}

static void put_matrix(FILE *out, const struct bench_plan *plan, unsigned index)
{
    size_t last = SIZE_MAX;
    fputs("wrong/leaks/acne of pixels against point, then wrong samples of those that decide 32\n", out);
    for (size_t i = 0; i < plan->cells.count; i++) {
        const struct bench_cell *cell = &plan->cells.data[i];
        if (!(cell->tables & 1u << index) || (!cell->started && !cell->failed[0]))
            continue;
        if (cell->setup != last)
            fprintf(out, "\n%s\n", model_label(plan->setups.data[cell->setup].scene));
        last = cell->setup;
        put_matrix_cell(out, cell);
    }
}

static bool has_rows(const struct bench_plan *plan, unsigned index)
{
    for (size_t i = 0; i < plan->cells.count; i++)
        if (plan->cells.data[i].tables & 1u << index && (plan->cells.data[i].started || plan->cells.data[i].failed[0]))
            return true;
    return false;
}

static void put_table(FILE *out, const struct bench_plan *plan, unsigned index)
{
    const struct bench_table *table = plan->suite->tables[index];
    if (!has_rows(plan, index))
        return;
    fprintf(out, "\n== %s\n%s\n", table->title, table->note);
    if (table->shape == SHAPE_MATRIX)
        put_matrix(out, plan, index);
    else
        put_rows(out, plan, index);
}

enum { GLANCES_MAX = 32, GOALS_MAX = 64 };

static void put_glances(FILE *out, const struct bench_plan *plan)
{
    struct bench_glance glances[GLANCES_MAX];
    size_t count = bench_glances(plan, glances, GLANCES_MAX);
    if (!count)
        return;
    fprintf(out, "\n== At a glance\nEach system at its defaults: medians over the scenes; ratios are to %s\n",
            glances[0].baseline);
    fprintf(out, "  %-12s %7s %9s %9s %9s %10s %9s %8s\n", "", "scenes", "still", "moving", "error", "wrong", "rmse32", "MiB");
    for (size_t i = 0; i < count; i++) {
        const struct bench_glance *g = &glances[i];
        fprintf(out, "  %-12s %7zu", g->system->name, g->setups);
        put_number(out, 8, "x%.2f", g->still_ratio, true);
        put_number(out, 8, "x%.2f", g->moving_ratio, true);
        put_number(out, 8, "x%.3f", g->error_ratio, true);
        put_number(out, 9, "%.6f", g->fraction, true);
        put_number(out, 8, "%.4f", g->rmse32, true);
        put_number(out, 7, "%.1f", g->mib, true);
        fputc('\n', out);
    }
}

static void put_goals(FILE *out, const struct bench_plan *plan)
{
    struct goal_result results[GOALS_MAX];
    size_t count = bench_goals_check(plan, results, GOALS_MAX);
    if (count)
        fputs("\n== Goals\n", out);
    for (size_t i = 0; i < count; i++)
        fprintf(out, "  %-6s %8.3f (goal %g)  %s\n", results[i].met ? "met" : "missed", results[i].value, results[i].goal->bound,
                results[i].sentence);
}

void bench_text(const struct bench_report *report, FILE *out)
{
    const struct bench_plan *plan = &report->plan;
    struct bench_findings findings;
    fprintf(out, "gnomon %s, suite %s, on %s, %u threads, %.0f s%s\n", GNOMON_VERSION, plan->suite->name, report->device.renderer,
            report->threads, report->seconds, report->interrupted ? ", interrupted" : "");
    for (unsigned i = 0; plan->suite->tables[i]; i++)
        put_table(out, plan, i);
    fputs(
        "\nstill, moving: medians of frames taken in turns, in ms; spread: between the quartiles; ratio: median of the frame by frame ratios\n"
        "to the baseline of the same map size. wrong, fraction, leaks, acne: misclassified pixels against point; edge95: 95 % of the shadow's\n"
        "edge is within that many 1/32 px. rmse32, samples: against samples32. MiB: what the system holds for its lights.\n"
        "lists: of the triangles that the light sees in a texel, the share that its list holds.\n",
        out);
    put_glances(out, plan);
    put_goals(out, plan);
    bench_findings_make(plan, &findings);
    fputs(findings.sentences.count ? "\n== Findings\n" : "", out);
    for (size_t i = 0; i < findings.sentences.count; i++)
        fprintf(out, "  %s\n", findings.sentences.data[i]);
    bench_findings_finish(&findings);
    for (size_t i = 0; i < plan->left_out.count; i++)
        fprintf(out, "note: %s\n", plan->left_out.data[i]);
}
