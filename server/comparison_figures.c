#include "comparison.h"
#include "figures.h"
#include "flicker_run.h"
#include "lights.h"
#include "output.h"
#include "stage.h"

void figures_add_identified(json_t *object, bool given, const struct identified *m)
{
    double texels = (double)m->texels, seen = (double)m->seen;
    const struct {
        const char *name;
        double value;
    } shares[] = {{"identified_fraction", m->fractions / texels},
                  {"identified_pooled", (double)m->found / seen},
                  {"identified_oracle5", m->oracle_fractions / texels},
                  {"identified_oracle5_pooled", (double)m->found_by_oracle / seen}};
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++)
        json_object_set_new(object, shares[i].name, given ? json_number(shares[i].value) : json_null());
    json_object_set_new(object, "identified_texels", given ? json_integer((json_int_t)m->texels) : json_null());
    json_object_set_new(object, "texels_over_4", given ? json_integer((json_int_t)m->texels_over_4) : json_null());
}

static void add_identified_total(json_t *object, const struct comparison *c)
{
    struct identified total = {0};
    bool given = false;
    for (size_t i = 0; i < c->light_count; i++) {
        given |= c->lists[i].given;
        identified_add(&total, &c->lists[i].result);
    }
    figures_add_identified(object, given, &total);
}

static json_t *light_rows(const struct stage *stage, const struct comparison *c)
{
    json_t *rows = json_array();
    for (size_t i = 0; i < c->light_count; i++) {
        const struct light *light = &stage->settings.lights[i];
        json_t *row = figures_errors(&c->light[i]);
        json_t *told = figures_told(c->figures[i], c->figure_count[i]);
        if (told)
            json_object_set_new(row, "figures", told);
        figures_add_identified(row, c->lists[i].given, &c->lists[i].result);
        json_object_set_new(row, "light", json_integer((json_int_t)i));
        json_object_set_new(row, "name", json_text(light->name));
        json_object_set_new(row, "kind", json_string(light_kind_names[light->kind]));
        json_array_append_new(rows, row);
    }
    return rows;
}

void figures_add_comparison(json_t *figures, const struct against *a, const struct stage *stage, const struct comparison *c)
{
    char against[300];
    against_format(a, against, sizeof against);
    json_t *errors = figures_errors(&c->total);
    json_object_update(figures, errors);
    json_decref(errors);
    add_identified_total(figures, c);
    if (stage->settings.system->converged)
        json_object_set_new(figures, "convergence",
                            json_pack("{s:I, s:b}", "frames", (json_int_t)c->converge_frames, "converged", c->converged));
    json_object_set_new(figures, "against", json_string(against));
    json_object_set_new(figures, "reference",
                        json_pack("{s:I, s:I, s:I, s:f}", "rays", (json_int_t)c->counts.rays, "tests",
                                  (json_int_t)c->counts.tests, "exact", (json_int_t)c->counts.exact, "ms", c->reference_ms));
    json_object_set_new(figures, "per_light", light_rows(stage, c));
}

void figures_add_flicker(json_t *figures, const struct flicker_figures *flicker)
{
    json_t *object = json_object(), *tested = json_object(), *reference = json_object();
    unsigned frames = 0;
    for (int i = 0; i < FLICKER_MOTIONS; i++) {
        bool measured = flicker[i].frames > 0;
        const char *name = flicker_motion_names[i];
        frames = measured ? flicker[i].frames : frames;
        json_object_set_new(object, name, measured ? json_number(flicker[i].difference) : json_null());
        json_object_set_new(tested, name, measured ? json_number(flicker[i].tested) : json_null());
        json_object_set_new(reference, name, measured ? json_number(flicker[i].reference) : json_null());
    }
    json_object_set_new(object, "tested", tested);
    json_object_set_new(object, "reference", reference);
    json_object_set_new(object, "frames", json_integer(frames));
    if (frames)
        json_object_set(figures, "flicker", object);
    json_decref(object);
}
