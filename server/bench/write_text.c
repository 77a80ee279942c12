#include <math.h>
#include <string.h>

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
    fprintf(out, "\n  %-34s %8s %7s %6s %8s %7s %6s %8s %9s %6s %6s %7s %7s %8s %7s\n", "", "still ms", "spread", "ratio",
            "moving", "spread", "ratio", "wrong", "fraction", "leaks", "acne", "edge95", "rmse32", "samples", "MiB");
}

static void put_table(FILE *out, const struct bench_plan *plan, unsigned index)
{
    const struct bench_table *table = plan->suite->tables[index];
    size_t last = SIZE_MAX;
    for (size_t i = 0; i < plan->cells.count; i++) {
        const struct bench_cell *cell = &plan->cells.data[i];
        if (!(cell->tables & 1u << index) || !cell->started)
            continue;
        if (last == SIZE_MAX)
            fprintf(out, "\n== %s\n%s\n", table->title, table->note);
        if (cell->setup != last)
            put_setup(out, &plan->setups.data[cell->setup]);
        last = cell->setup;
        put_row(out, plan, table, cell);
    }
}

void bench_text(const struct bench_report *report, FILE *out)
{
    const struct bench_plan *plan = &report->plan;
    fprintf(out, "gnomon %s, suite %s, on %s, %u threads, %.0f s%s\n", GNOMON_VERSION, plan->suite->name, report->device.renderer,
            report->threads, report->seconds, report->interrupted ? ", interrupted" : "");
    for (unsigned i = 0; plan->suite->tables[i]; i++)
        put_table(out, plan, i);
    fputs(
        "\nstill, moving: medians of frames taken in turns, in ms; spread: between the quartiles; ratio: median of the frame by frame ratios\n"
        "to the baseline of the same map size. wrong, fraction, leaks, acne: misclassified pixels against point; edge95: 95 % of the shadow's\n"
        "edge is within that many 1/32 px. rmse32, samples: against samples32. MiB: what the system holds for its lights.\n",
        out);
    for (size_t i = 0; i < plan->left_out.count; i++)
        fprintf(out, "note: %s\n", plan->left_out.data[i]);
}
