#include <math.h>

#include "findings.h"
#include "goals.h"
#include "html.h"
#include "html_sections.h"

enum { GLANCES_MAX = 32, GOALS_MAX = 64 };

static void put_ratio(FILE *out, double value)
{
    fputs("<td>", out);
    if (isfinite(value))
        fputs("×", out);
    html_put_number(out, value);
    fputs("</td>", out);
}

static void put_value(FILE *out, double value)
{
    fputs("<td>", out);
    html_put_number(out, value);
    fputs("</td>", out);
}

static void put_glance(const struct bench_glance *g, FILE *out)
{
    fprintf(out, "<tr><td><span class=\"dot c%u\"></span>%s <span class=soft>%s</span></td><td>%zu</td>", html_color(g->system),
            g->system->name, g->system->title, g->setups);
    put_ratio(out, g->still_ratio);
    put_ratio(out, g->moving_ratio);
    put_ratio(out, g->error_ratio);
    put_value(out, 100 * g->fraction);
    put_value(out, g->rmse32);
    put_value(out, g->mib);
    fputs("</tr>\n", out);
}

static void put_glances(const struct bench_plan *plan, FILE *out)
{
    struct bench_glance glances[GLANCES_MAX];
    size_t count = bench_glances(plan, glances, GLANCES_MAX);
    if (!count)
        return;
    fprintf(
        out,
        "<h3>At a glance</h3><p class=note>Each system at its defaults: medians over the scenes. Ratios are to <code>%s</code>, paired frame "
        "by frame; errors to its best.</p><div class=scroll><table><tr><th>system<th>scenes<th>frame, light still<th>light moving<th>wrong "
        "pixels<th>wrong, %%<th>RMSE, 32 samples<th>MiB</tr>\n",
        glances[0].baseline);
    for (size_t i = 0; i < count; i++)
        put_glance(&glances[i], out);
    fputs("</table></div>\n", out);
}

static void put_goals(const struct bench_plan *plan, FILE *out)
{
    struct goal_result results[GOALS_MAX];
    size_t count = bench_goals_check(plan, results, GOALS_MAX);
    if (!count)
        return;
    fputs("<h3>Goals</h3><div class=scroll><table><tr><th>what<th>measured<th>goal<th></tr>\n", out);
    for (size_t i = 0; i < count; i++) {
        const struct goal_result *r = &results[i];
        bool least = r->goal->kind == GOAL_VISIBILITY_GAIN || r->goal->kind == GOAL_VISIBILITY_GAIN_MOVING;
        fputs("<tr><td>", out);
        html_put_text(out, r->sentence);
        fputs("</td>", out);
        put_value(out, r->value);
        fprintf(out, "<td>%s %g</td><td class=%s>%s</td></tr>\n", least ? "≥" : "≤", r->goal->bound, r->met ? "met" : "missed",
                r->met ? "met" : "missed");
    }
    fputs("</table></div>\n", out);
}

void html_put_summary(const struct bench_report *report, FILE *out)
{
    struct bench_findings findings;
    bench_findings_make(&report->plan, &findings);
    fputs("<section id=short><h2>In short</h2>\n<ul>\n", out);
    for (size_t i = 0; i < findings.sentences.count; i++) {
        fputs("<li>", out);
        html_put_text(out, findings.sentences.data[i]);
        fputs("</li>\n", out);
    }
    fputs("</ul>\n", out);
    bench_findings_finish(&findings);
    put_glances(&report->plan, out);
    put_goals(&report->plan, out);
    fputs("</section>\n", out);
}
