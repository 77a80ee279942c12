#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "front.h"
#include "html.h"
#include "html_sections.h"
#include "models.h"
#include "plot.h"
#include "series.h"

/* An error that can be set against time. */
struct measure {
    const char *title, *label;
    int reference;
    double (*value)(const struct metrics *m);
    bool linear;
};

static double fraction(const struct metrics *m) { return 100 * m->misclassified_fraction; }
static double rmse(const struct metrics *m) { return m->rmse; }
static double shift(const struct metrics *m) { return m->boundary.edge_shift_p95 / 32; }

static const struct measure measures[] = {
    {"misclassified pixels", "misclassified, % of receivers", AGAINST_POINT_INDEX, fraction, false},
    {"RMSE against 32 samples a pixel", "RMSE of visibility", AGAINST_SAMPLES32_INDEX, rmse, false},
    {"shift of the shadow's edge", "95 % of the edge within, px", AGAINST_POINT_INDEX, shift, false},
};

enum { MEASURES = sizeof measures / sizeof measures[0], CELLS_MIN = 3 };

static double median_ms(const struct bench_cell *c, int regime)
{
    const struct bench_times *t = &c->times[regime];
    return t->measured ? series_of(t->frame_ms, t->rounds).median : NAN;
}

static struct plot_point point_of(const struct bench_cell *cell, const struct measure *m, int regime)
{
    const struct bench_errors *e = &cell->errors[m->reference];
    struct plot_point p = {
        .x = median_ms(cell, regime), .y = e->measured ? m->value(&e->m) : NAN, .color = html_color(cell->system)};
    html_short_name(cell->name, p.name, sizeof p.name);
    snprintf(p.hover, sizeof p.hover, "%s: %.2f ms, %s %.4g", cell->name, p.x, m->label, p.y);
    return p;
}

static void put_scatter(const struct bench_plan *plan, size_t setup, const struct measure *m, int regime, FILE *out)
{
    size_t all = plan->cells.count, count = 0;
    struct plot_point *points = calloc(all, sizeof *points);
    struct front_point *pairs = calloc(all, sizeof *pairs);
    bool *on_front = calloc(all, sizeof *on_front);
    for (size_t i = 0; points && pairs && on_front && i < all; i++) {
        const struct bench_cell *cell = &plan->cells.data[i];
        if (cell->setup != setup || !cell->times[regime].measured || !cell->errors[m->reference].measured)
            continue;
        points[count] = point_of(cell, m, regime);
        pairs[count] = (struct front_point){points[count].x, points[count].y};
        count++;
    }
    if (count >= CELLS_MIN) {
        char title[500];
        front_mark(pairs, count, on_front);
        for (size_t i = 0; i < count; i++)
            points[i].on_front = on_front[i];
        snprintf(title, sizeof title, "%s, light %s", model_label(plan->setups.data[setup].scene), bench_regime_names[regime]);
        const struct plot plot = {title, "median frame, ms", m->label, true, !m->linear, points, count};
        plot_put(&plot, out);
    }
    free(on_front);
    free(pairs);
    free(points);
}

/* How many cells of a setup have both. */
static size_t count_points(const struct bench_plan *plan, size_t setup, const struct measure *m)
{
    size_t n = 0;
    for (size_t i = 0; i < plan->cells.count; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        n += c->setup == setup && c->errors[m->reference].measured && (c->times[0].measured || c->times[1].measured);
    }
    return n;
}

static bool any_points(const struct bench_plan *plan, const struct measure *m)
{
    for (size_t s = 0; s < plan->setups.count; s++)
        if (count_points(plan, s, m) >= CELLS_MIN)
            return true;
    return false;
}

static void put_plots(const struct bench_plan *plan, const struct measure *m, FILE *out)
{
    fputs("<div class=plots>\n", out);
    for (size_t s = 0; s < plan->setups.count; s++)
        for (int r = 0; r < REGIME_COUNT; r++)
            put_scatter(plan, s, m, r, out);
    fputs("</div>\n", out);
}

static bool is_used(const struct bench_plan *plan, const struct shadow_system *system)
{
    for (size_t i = 0; i < plan->cells.count; i++)
        if (plan->cells.data[i].system == system && plan->cells.data[i].started)
            return true;
    return false;
}

static void put_legend(const struct bench_plan *plan, FILE *out)
{
    fputs("<div class=legend>", out);
    for (size_t i = 0; i < shadow_system_count; i++)
        if (is_used(plan, shadow_systems[i]))
            fprintf(out, "<span class=c%u><i>%s</i></span>", html_color(shadow_systems[i]), shadow_systems[i]->name);
    fputs("</div>\n", out);
}

void html_put_fronts(const struct bench_report *report, FILE *out)
{
    const struct bench_plan *plan = &report->plan;
    if (!any_points(plan, &measures[0]))
        return;
    fputs(
        "<section id=front><h2>Time against error</h2><p class=note>Down and to the left is better. Ringed, joined by the dashed line: the "
        "Pareto front, what nothing else beats in both. Point at a mark for its parameters.</p>\n",
        out);
    put_legend(plan, out);
    put_plots(plan, &measures[0], out);
    for (size_t i = 1; i < MEASURES; i++) {
        if (!any_points(plan, &measures[i]))
            continue;
        fprintf(out, "<details><summary>The same with the %s</summary>\n", measures[i].title);
        put_plots(plan, &measures[i], out);
        fputs("</details>\n", out);
    }
    fputs("</section>\n", out);
}
