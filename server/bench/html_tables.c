#include <math.h>
#include <string.h>

#include "html.h"
#include "html_sections.h"
#include "models.h"
#include "series.h"

bool html_table_has_rows(const struct bench_plan *plan, unsigned table)
{
    for (size_t i = 0; i < plan->cells.count; i++)
        if (plan->cells.data[i].tables & 1u << table && (plan->cells.data[i].started || plan->cells.data[i].failed[0]))
            return true;
    return false;
}

static bool belongs(const struct bench_cell *cell, unsigned table)
{
    return cell->tables & 1u << table && (cell->started || cell->failed[0]);
}

static void put_value(FILE *out, double value, bool measured)
{
    fputs("<td>", out);
    html_put_number(out, measured ? value : NAN);
    fputs("</td>", out);
}

static void put_count(FILE *out, uint64_t value, bool measured)
{
    if (measured)
        fprintf(out, "<td>%llu</td>", (unsigned long long)value);
    else
        fputs("<td>–</td>", out);
}

static void put_times(FILE *out, const struct bench_times *t, const struct bench_times *base)
{
    struct series s = series_of(t->frame_ms, t->measured ? t->rounds : 0);
    bool both = base && base->measured && t->measured && base->rounds == t->rounds;
    if (t->measured)
        fprintf(out, "<td title=\"%zu frames, %.2f to %.2f\">%.2f <span class=spread>%.1f–%.1f</span></td>", s.count, s.min,
                s.max, s.median, s.q1, s.q3);
    else
        fputs("<td>–</td>", out);
    struct series ratio = series_of_ratios(t->frame_ms, both ? base->frame_ms : NULL, both ? t->rounds : 0);
    if (both)
        fprintf(out, "<td title=\"quartiles %.2f to %.2f\">%+.0f&nbsp;%%</td>", ratio.q1, ratio.q3, 100 * (ratio.median - 1));
    else
        fputs("<td>–</td>", out);
}

static void put_row(FILE *out, const struct bench_plan *plan, const struct bench_table *table, const struct bench_cell *c)
{
    const struct bench_cell *base = bench_baseline(plan, c, table->baseline);
    const struct bench_errors *point = &c->errors[AGAINST_POINT_INDEX], *full = &c->errors[AGAINST_SAMPLES32_INDEX],
                              *area = &c->errors[AGAINST_AREALIGHT_INDEX];
    int64_t best = bench_best_misclassified(plan, c, table->baseline);
    const struct bench_times *moving = &c->times[REGIME_MOVING];
    fprintf(out, "<tr><td><span class=\"dot c%u\"></span><code>", html_color(c->system));
    html_put_text(out, c->name);
    fputs("</code></td>", out);
    for (int r = 0; r < REGIME_COUNT; r++)
        put_times(out, &c->times[r], base ? &base->times[r] : NULL);
    put_value(out, moving->pass_ms[PASS_PREPARE], moving->passes_measured);
    put_value(out, moving->pass_ms[PASS_RESOLVE], moving->passes_measured);
    put_count(out, point->m.misclassified, point->measured);
    put_value(out, 100 * point->m.misclassified_fraction, point->measured);
    put_value(out, (double)point->m.misclassified / (double)best, point->measured && best > 0);
    put_count(out, point->m.leaks, point->measured);
    put_count(out, point->m.acne, point->measured);
    put_value(out, point->m.boundary.edge_shift_p95, point->measured);
    put_value(out, full->m.rmse, full->measured);
    put_count(out, (uint64_t)full->m.wrong_samples, full->measured && full->m.wrong_samples >= 0);
    if (table->measures & MEASURE_AREALIGHT)
        put_value(out, area->m.rmse, area->measured);
    put_value(out, (double)c->shadow_bytes / (1 << 20), c->times[0].measured || c->times[1].measured);
    put_value(out, bench_identified_fraction(c), true);
    fputs("</tr>\n", out);
    if (c->failed[0]) {
        fputs("<tr><td></td><td class=failed colspan=17>", out);
        html_put_text(out, c->failed);
        fputs("</td></tr>\n", out);
    }
}

static void put_setup(FILE *out, const struct bench_table *table, const struct bench_setup *s)
{
    fputs("<h3>", out);
    html_put_text(out, model_label(s->scene));
    fprintf(out, " <span class=soft>%u × %u, %zu triangles drawn", s->width, s->height, s->drawn_triangles);
    if (s->lights)
        fprintf(out, ", %u light%s", s->lights, s->lights == 1 ? "" : "s");
    fputs(
        "</span></h3><div class=scroll><table><tr><th>algorithm<th>still, ms<th>over<th>moving, ms<th>over<th>prepare<th>resolve<th>wrong<th>%<th>of best"
        "<th>leaks<th>acne<th>edge 95 %<th>RMSE 32<th>wrong samples",
        out);
    fputs(table->measures & MEASURE_AREALIGHT ? "<th>RMSE area<th>MiB<th>lists hold</tr>\n" : "<th>MiB<th>lists hold</tr>\n",
          out);
}

static void put_rows(FILE *out, const struct bench_plan *plan, unsigned index)
{
    size_t last = SIZE_MAX;
    for (size_t i = 0; i < plan->cells.count; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        if (!belongs(c, index))
            continue;
        if (c->setup != last) {
            fputs(last == SIZE_MAX ? "" : "</table></div>\n", out);
            put_setup(out, plan->suite->tables[index], &plan->setups.data[c->setup]);
        }
        last = c->setup;
        put_row(out, plan, plan->suite->tables[index], c);
    }
    fputs("</table></div>\n", out);
}

enum { COLUMNS_MAX = 64 };

/* The algorithms of a matrix, each once, in the order in which the first scene has them. */
static size_t find_columns(const struct bench_plan *plan, unsigned index, const struct bench_cell *columns[COLUMNS_MAX])
{
    size_t count = 0;
    for (size_t i = 0; i < plan->cells.count; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        bool known = !belongs(c, index);
        for (size_t k = 0; !known && k < count; k++)
            known = !strcmp(columns[k]->name, c->name);
        if (!known && count < COLUMNS_MAX)
            columns[count++] = c;
    }
    return count;
}

static const struct bench_cell *find_cell(const struct bench_plan *plan, unsigned index, size_t setup, const char *name)
{
    for (size_t i = 0; i < plan->cells.count; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        if (c->setup == setup && belongs(c, index) && !strcmp(c->name, name))
            return c;
    }
    return NULL;
}

/* From one pixel in a million to one in ten, logarithmically. */
static double heat(double part) { return part > 0 ? fmin(fmax((log10(part) + 6) / 5, 0.05), 1) * 0.75 : 0; }

static void put_matrix_cell(FILE *out, const struct bench_cell *c)
{
    const struct bench_errors *point = c ? &c->errors[AGAINST_POINT_INDEX] : NULL,
                              *full = c ? &c->errors[AGAINST_SAMPLES32_INDEX] : NULL;
    if (c && c->failed[0]) {
        fputs("<td title=\"", out);
        html_put_text(out, c->failed);
        fputs("\" class=missed>failed</td>", out);
        return;
    }
    if (!point || !point->measured) {
        fputs("<td>–</td>", out);
        return;
    }
    bool masks = full->measured && full->m.wrong_samples >= 0;
    bool right = masks ? full->m.wrong_samples == 0 : point->m.misclassified == 0;
    double share =
        masks ? (double)full->m.wrong_samples / 32 / fmax((double)full->m.receivers, 1) : point->m.misclassified_fraction;
    fprintf(out, "<td class=\"%s\" style=\"--h:%.2f\" title=\"%llu misclassified (%.3g %%), %llu leaks, %llu acne",
            right ? "right" : "heat", heat(share), (unsigned long long)point->m.misclassified,
            100 * point->m.misclassified_fraction, (unsigned long long)point->m.leaks, (unsigned long long)point->m.acne);
    fprintf(out, "; RMSE against 32 samples %.4f\">", full->measured ? full->m.rmse : NAN);
    if (masks)
        fprintf(out, "%lld<span class=spread> s</span></td>", (long long)full->m.wrong_samples);
    else
        fprintf(out, "%llu <span class=spread>%llu/%llu</span></td>", (unsigned long long)point->m.misclassified,
                (unsigned long long)point->m.leaks, (unsigned long long)point->m.acne);
}

static void put_matrix(FILE *out, const struct bench_plan *plan, unsigned index)
{
    const struct bench_cell *columns[COLUMNS_MAX];
    size_t count = find_columns(plan, index, columns);
    fputs(
        "<p class=note>Misclassified pixels against point, behind them leaks/acne; for what decides 32 samples a pixel the wrong samples (s). The "
        "stronger the colour, the larger their share.</p><div class=scroll><table><tr><th>scene",
        out);
    for (size_t i = 0; i < count; i++) {
        fputs("<th>", out);
        html_put_text(out, columns[i]->name);
    }
    fputs("</tr>\n", out);
    for (size_t s = 0; s < plan->setups.count; s++) {
        bool here = false;
        for (size_t i = 0; i < count && !here; i++)
            here = find_cell(plan, index, s, columns[i]->name) != NULL;
        if (!here)
            continue;
        fputs("<tr><td>", out);
        html_put_text(out, model_label(plan->setups.data[s].scene));
        fputs("</td>", out);
        for (size_t i = 0; i < count; i++)
            put_matrix_cell(out, find_cell(plan, index, s, columns[i]->name));
        fputs("</tr>\n", out);
    }
    fputs("</table></div>\n", out);
}

void html_put_tables(const struct bench_report *report, FILE *out)
{
    const struct bench_plan *plan = &report->plan;
    for (unsigned t = 0; plan->suite->tables[t]; t++) {
        const struct bench_table *table = plan->suite->tables[t];
        if (!html_table_has_rows(plan, t))
            continue;
        fprintf(out, "<section id=\"%s\"><h2>", table->name);
        html_put_text(out, table->title);
        fputs("</h2><p class=note>", out);
        html_put_text(out, table->note);
        fputs("</p>\n", out);
        if (table->shape == SHAPE_MATRIX)
            put_matrix(out, plan, t);
        else
            put_rows(out, plan, t);
        fputs("</section>\n", out);
    }
}
