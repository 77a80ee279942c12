#include <math.h>
#include <string.h>

#include "series.h"
#include "write.h"

static void put_text(FILE *out, const char *text)
{
    fputc('"', out);
    for (; *text; text++)
        fputs(*text == '"' ? "\"\"" : (char[]){*text, 0}, out);
    fputc('"', out);
}

static void put_number(FILE *out, double value, bool measured)
{
    fputc(',', out);
    if (measured && isfinite(value))
        fprintf(out, "%.9g", value);
}

static void put_times(FILE *out, const struct bench_times *t)
{
    struct series s = series_of(t->frame_ms, t->measured ? t->rounds : 0);
    put_number(out, s.median, t->measured);
    put_number(out, s.q1, t->measured);
    put_number(out, s.q3, t->measured);
    for (int p = 0; p < PASS_COUNT; p++)
        put_number(out, t->pass_ms[p], t->passes_measured);
}

static void put_errors(FILE *out, const struct bench_errors *e)
{
    const double values[] = {
        (double)e->m.receivers, (double)e->m.misclassified, e->m.misclassified_fraction,   e->m.rmse,
        (double)e->m.leaks,     (double)e->m.acne,          e->m.boundary.edge_shift_mean, e->m.boundary.edge_shift_p95};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
        put_number(out, values[i], e->measured);
    put_number(out, (double)e->m.wrong_samples, e->measured && e->m.wrong_samples >= 0);
}

static void put_header(FILE *out)
{
    static const char *const of_errors[] = {"receivers", "misclassified",   "misclassified_fraction", "rmse",         "leaks",
                                            "acne",      "edge_shift_mean", "edge_shift_p95",         "wrong_samples"};
    fputs("scene,drawn_triangles,width,height,lights,algorithm,system,map_size,shadow_bytes_max", out);
    for (int r = 0; r < REGIME_COUNT; r++) {
        fprintf(out, ",%s_ms,%s_q1,%s_q3", bench_regime_names[r], bench_regime_names[r], bench_regime_names[r]);
        for (int p = 0; p < PASS_COUNT; p++)
            fprintf(out, ",%s_%s_ms", bench_regime_names[r], render_pass_names[p]);
    }
    for (int e = 0; e < BENCH_REFERENCES; e++)
        for (size_t i = 0; i < sizeof of_errors / sizeof of_errors[0]; i++)
            fprintf(out, ",%s_%s", bench_reference_names[e], of_errors[i]);
    fputs(",identified_fraction,identified_pooled,texels_over_4,failed\r\n", out);
}

void bench_csv(const struct bench_report *report, FILE *out)
{
    const struct bench_plan *plan = &report->plan;
    put_header(out);
    for (size_t i = 0; i < plan->cells.count; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        const struct bench_setup *s = &plan->setups.data[c->setup];
        put_text(out, s->scene);
        fprintf(out, ",%zu,%u,%u,%u,", s->drawn_triangles, s->width, s->height, s->lights);
        put_text(out, c->name);
        fprintf(out, ",%s,%u,%zu", c->system->name, c->map_size, c->shadow_bytes);
        for (int r = 0; r < REGIME_COUNT; r++)
            put_times(out, &c->times[r]);
        for (int e = 0; e < BENCH_REFERENCES; e++)
            put_errors(out, &c->errors[e]);
        put_number(out, bench_identified_fraction(c), c->has_lists);
        put_number(out, (double)c->lists.found / (double)c->lists.seen, c->has_lists);
        put_number(out, (double)c->lists.texels_over_4, c->has_lists);
        fputc(',', out);
        put_text(out, c->failed);
        fputs("\r\n", out);
    }
}
