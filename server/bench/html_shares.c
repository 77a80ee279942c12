#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "html.h"
#include "html_sections.h"
#include "models.h"
#include "plot.h"

enum { BARS_MAX = 64, BARS_MIN = 2 };

/* Of tables in rows: the others repeat the same systems many times. */
static bool in_rows(const struct bench_plan *plan, const struct bench_cell *cell)
{
    for (unsigned t = 0; plan->suite->tables[t]; t++)
        if (cell->tables & 1u << t && plan->suite->tables[t]->shape == SHAPE_ROWS)
            return true;
    return false;
}

static void put_passes(const struct bench_plan *plan, size_t setup, int regime, FILE *out)
{
    struct plot_bar bars[BARS_MAX];
    char title[500];
    size_t count = 0;
    for (size_t i = 0; i < plan->cells.count && count < BARS_MAX; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        if (c->setup != setup || !c->times[regime].passes_measured || !in_rows(plan, c))
            continue;
        html_short_name(c->name, bars[count].name, sizeof bars[count].name);
        memcpy(bars[count].values, c->times[regime].pass_ms, sizeof c->times[regime].pass_ms);
        count++;
    }
    snprintf(title, sizeof title, "%s, light %s, ms", model_label(plan->setups.data[setup].scene), bench_regime_names[regime]);
    if (count >= BARS_MIN)
        plot_put_bars(title, "ms", render_pass_names, PASS_COUNT, bars, count, out);
}

static void put_memory(const struct bench_plan *plan, size_t setup, FILE *out)
{
    static const char *const parts[] = {"shadow memory"};
    struct plot_bar bars[BARS_MAX];
    char title[500];
    size_t count = 0;
    for (size_t i = 0; i < plan->cells.count && count < BARS_MAX; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        if (c->setup != setup || !c->times[REGIME_STILL].measured || !in_rows(plan, c))
            continue;
        html_short_name(c->name, bars[count].name, sizeof bars[count].name);
        bars[count++].values[0] = (double)c->shadow_bytes / (1 << 20);
    }
    snprintf(title, sizeof title, "%s, MiB", model_label(plan->setups.data[setup].scene));
    if (count >= BARS_MIN)
        plot_put_bars(title, "MiB", parts, 1, bars, count, out);
}

static bool any_passes(const struct bench_plan *plan)
{
    for (size_t i = 0; i < plan->cells.count; i++)
        if (in_rows(plan, &plan->cells.data[i]) &&
            (plan->cells.data[i].times[0].passes_measured || plan->cells.data[i].times[1].passes_measured))
            return true;
    return false;
}

void html_put_shares(const struct bench_report *report, FILE *out)
{
    const struct bench_plan *plan = &report->plan;
    if (!any_passes(plan))
        return;
    fputs(
        "<section id=passes><h2>Where the time goes</h2><p class=note>Medians of frames with a finish after each pass, so a little more than a frame in "
        "one go. <em>prepare</em> is paid only when light or geometry changed, <em>resolve</em> in every frame.</p><div class=legend>",
        out);
    for (int p = 0; p < PASS_COUNT; p++)
        fprintf(out, "<span class=b%d><i>%s</i></span>", p, render_pass_names[p]);
    fputs("</div><div class=plots>\n", out);
    for (size_t s = 0; s < plan->setups.count; s++)
        put_passes(plan, s, REGIME_MOVING, out);
    fputs("</div><details><summary>The same with the light still</summary><div class=plots>\n", out);
    for (size_t s = 0; s < plan->setups.count; s++)
        put_passes(plan, s, REGIME_STILL, out);
    fputs("</div></details><details id=memory><summary>Memory that each holds for its lights</summary><div class=plots>\n", out);
    for (size_t s = 0; s < plan->setups.count; s++)
        put_memory(plan, s, out);
    fputs("</div></details></section>\n", out);
}
