#include "comparison.h"
#include "figures.h"
#include "lights.h"
#include "output.h"
#include "stage.h"

static json_t *light_rows(const struct stage *stage, const struct comparison *c)
{
    json_t *rows = json_array();
    for (size_t i = 0; i < c->light_count; i++) {
        const struct light *light = &stage->settings.lights[i];
        json_t *row = figures_errors(&c->light[i]);
        json_t *told = figures_told(c->figures[i], c->figure_count[i]);
        if (told)
            json_object_set_new(row, "figures", told);
        json_object_set_new(row, "light", json_integer((json_int_t)i));
        json_object_set_new(row, "name", json_text(light->name));
        json_object_set_new(row, "kind", json_string(light_kind_names[light->kind]));
        json_array_append_new(rows, row);
    }
    return rows;
}

void figures_add_comparison(json_t *figures, const struct against *a, const struct stage *stage, const struct comparison *c)
{
    static const char *const of_lists[] = {"identified_fraction", "identified_pooled", "texels_over_4"};
    char against[300];
    against_format(a, against, sizeof against);
    json_t *errors = figures_errors(&c->total);
    json_object_update(figures, errors);
    json_decref(errors);
    for (size_t i = 0; i < sizeof of_lists / sizeof of_lists[0]; i++)
        json_object_set_new(figures, of_lists[i], json_null());
    if (stage->settings.system->converged)
        json_object_set_new(figures, "convergence",
                            json_pack("{s:I, s:b}", "frames", (json_int_t)c->converge_frames, "converged", c->converged));
    json_object_set_new(figures, "against", json_string(against));
    json_object_set_new(figures, "reference",
                        json_pack("{s:I, s:I, s:I, s:f}", "rays", (json_int_t)c->counts.rays, "tests",
                                  (json_int_t)c->counts.tests, "exact", (json_int_t)c->counts.exact, "ms", c->reference_ms));
    json_object_set_new(figures, "per_light", light_rows(stage, c));
}
