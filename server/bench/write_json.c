#include <stdio.h>

#include "figures.h"
#include "output.h"
#include "series.h"
#include "write.h"

static json_t *series_json(const struct series *s)
{
    return json_pack("{s:I, s:o, s:o, s:o, s:o, s:o}", "frames", (json_int_t)s->count, "min", json_number(s->min), "q1",
                     json_number(s->q1), "median", json_number(s->median), "q3", json_number(s->q3), "max", json_number(s->max));
}

static json_t *passes_json(const struct bench_times *t)
{
    if (!t->passes_measured)
        return json_null();
    json_t *object = json_object();
    for (int p = 0; p < PASS_COUNT; p++) {
        char name[32];
        snprintf(name, sizeof name, "%s_ms", render_pass_names[p]);
        json_object_set_new(object, name, json_number(t->pass_ms[p]));
    }
    json_object_set_new(object, "visibility_ms",
                        json_number(t->pass_ms[PASS_RECEIVERS] + t->pass_ms[PASS_PREPARE] + t->pass_ms[PASS_RESOLVE]));
    return object;
}

static json_t *times_json(const struct bench_plan *plan, const struct bench_cell *cell, int regime)
{
    const struct bench_times *t = &cell->times[regime];
    if (!t->measured)
        return json_null();
    struct series s = series_of(t->frame_ms, t->rounds);
    json_t *object = json_pack("{s:o, s:o}", "frame_ms", series_json(&s), "passes", passes_json(t));
    const char *system = bench_cell_baseline_name(plan, cell);
    const struct bench_cell *base = bench_baseline(plan, cell, system);
    if (base && base->times[regime].measured && base->times[regime].rounds == t->rounds) {
        struct series ratio = series_of_ratios(t->frame_ms, base->times[regime].frame_ms, t->rounds);
        json_object_set_new(object, "ratio", series_json(&ratio));
        json_object_set_new(object, "ratio_to", json_string(base->name));
    }
    return object;
}

static json_t *params_string(const struct bench_cell *cell)
{
    char text[300];
    shadow_format(cell->system, &cell->params, text, sizeof text);
    return json_string(text);
}

static json_t *tables_json(const struct bench_plan *plan, const struct bench_cell *cell)
{
    json_t *names = json_array();
    for (unsigned i = 0; plan->suite->tables[i]; i++)
        if (cell->tables & 1u << i)
            json_array_append_new(names, json_string(plan->suite->tables[i]->name));
    return names;
}

static json_t *cell_json(const struct bench_plan *plan, const struct bench_cell *cell)
{
    const struct bench_setup *setup = &plan->setups.data[cell->setup];
    json_t *object =
        json_pack("{s:o, s:o, s:I, s:s, s:o, s:s, s:o, s:[I, I], s:o, s:I}", "tables", tables_json(plan, cell), "scene",
                  json_text(setup->scene), "drawn_triangles", (json_int_t)setup->drawn_triangles, "system", cell->system->name,
                  "algorithm", params_string(cell), "name", cell->name, "params", figures_params(cell->system, &cell->params),
                  "size", (json_int_t)setup->width, (json_int_t)setup->height, "lights",
                  setup->lights ? json_integer(setup->lights) : json_null(), "shadow_bytes_max", (json_int_t)cell->shadow_bytes);
    for (int r = 0; r < REGIME_COUNT; r++)
        json_object_set_new(object, bench_regime_names[r], times_json(plan, cell, r));
    for (int e = 0; e < BENCH_REFERENCES; e++)
        json_object_set_new(object, bench_reference_names[e],
                            cell->errors[e].measured ? figures_errors(&cell->errors[e].m) : json_null());
    figures_add_identified(object, cell->has_lists, &cell->lists);
    json_object_set_new(object, "failed", cell->failed[0] ? json_text(cell->failed) : json_null());
    json_object_set_new(object, "done", json_boolean(cell->started));
    return object;
}

static json_t *strings_json(char *const *strings, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(array, json_text(strings[i]));
    return array;
}

json_t *bench_json(const struct bench_report *report)
{
    const struct bench_plan *plan = &report->plan;
    char started[40];
    struct tm utc;
    strftime(started, sizeof started, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&report->started, &utc));
    json_t *cells = json_array();
    for (size_t i = 0; i < plan->cells.count; i++)
        json_array_append_new(cells, cell_json(plan, &plan->cells.data[i]));
    return json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:I, s:s, s:f, s:b, s:I, s:o, s:o}", "version", GNOMON_VERSION, "suite",
                     plan->suite->name, "command", json_text(report->command), "device", json_text(report->device.renderer),
                     "driver", json_text(report->device.version), "processor", json_text(report->processor), "threads",
                     (json_int_t)report->threads, "started", started, "seconds", report->seconds, "interrupted",
                     report->interrupted, "frames", (json_int_t)plan->frames, "left_out",
                     strings_json(plan->left_out.data, plan->left_out.count), "cells", cells);
}
