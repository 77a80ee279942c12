#include "figures.h"

#include <stdio.h>
#include <sys/resource.h>

#include "measure.h"
#include "numbers.h"
#include "output.h"
#include "reference/metrics.h"

static json_t *param_value(const struct param_desc *desc, double value)
{
    switch (desc->kind) {
    case PARAM_INT: return json_integer((json_int_t)value);
    case PARAM_FLOAT: return json_number(value);
    case PARAM_CHOICE: break;
    }
    const char *choice = desc->choices[(size_t)value];
    unsigned long number;
    if (number_parse_unsigned(choice, 0, 1ul << 30, &number))
        return json_integer((json_int_t)number);
    return json_string(choice);
}

json_t *figures_params(const struct shadow_system *system, const struct shadow_params *params)
{
    json_t *object = json_object();
    for (size_t i = 0; object && i < system->param_count; i++)
        json_object_set_new(object, system->params[i].name, param_value(&system->params[i], params->value[i]));
    return object;
}

static json_t *maps(const struct frame_info *frame)
{
    json_t *array = json_array();
    for (unsigned i = 0; i < frame->map_count; i++)
        json_array_append_new(
            array, json_pack("{s:I, s:o}", "size", (json_int_t)frame->map_size, "fov_deg", json_number(frame->map_fov_deg[i])));
    return array;
}

static json_t *passes(const struct measurement *m)
{
    json_t *object = json_object();
    for (int p = 0; p < PASS_COUNT; p++) {
        char name[32];
        snprintf(name, sizeof name, "%s_ms", render_pass_names[p]);
        json_object_set_new(object, name, json_number(m->pass_ms[p]));
    }
    return object;
}

/* Peak resident set; getrusage() counts kibibytes on Linux. */
static json_int_t peak_bytes(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (json_int_t)usage.ru_maxrss * 1024 : 0;
}

json_t *figures_told(const struct shadow_figure *figures, size_t count)
{
    json_t *object = count ? json_object() : NULL;
    for (size_t i = 0; object && i < count; i++)
        json_object_set_new(object, figures[i].name, json_number(figures[i].value));
    return object;
}

json_t *figures_render(const struct scene *scene, const struct render_settings *settings, const struct device_info *device,
                       const struct measurement *m)
{
    double visibility = m->pass_ms[PASS_RECEIVERS] + m->pass_ms[PASS_PREPARE] + m->pass_ms[PASS_RESOLVE];
    json_t *convergence = m->converge_frames
                              ? json_pack("{s:I, s:b}", "frames", (json_int_t)m->converge_frames, "converged", m->last.converged)
                              : NULL;
    return json_pack(
        "{s:s, s:o, s:{s:I, s:I, s:I, s:I}, s:s, s:o, s:o, s:[I, I], s:I, s:b, s:{s:o, s:o, s:o}, s:o, s:o, s:{s:I, s:I, s:I}, s:o*, "
        "s:o*}",
        "version", GNOMON_VERSION, "device", json_text(device->renderer), "scene", "triangles", (json_int_t)scene->triangle_count,
        "drawn_triangles", (json_int_t)scene->drawn_triangle_count, "vertices", (json_int_t)scene->vertex_count, "lights",
        (json_int_t)settings->light_count, "algorithm", settings->system->name, "params",
        figures_params(settings->system, &settings->params), "maps", maps(&m->last), "size", (json_int_t)settings->width,
        (json_int_t)settings->height, "frames", (json_int_t)m->frames, "moving", m->moving, "frame_ms", "min",
        json_number(m->min_ms), "median", json_number(m->median_ms), "p95", json_number(m->p95_ms), "passes", passes(m),
        "visibility_ms", json_number(visibility), "memory", "shadow_bytes", (json_int_t)m->shadow_bytes, "shadow_bytes_max",
        (json_int_t)m->shadow_bytes_max, "peak_bytes", peak_bytes(), "convergence", convergence, "figures",
        figures_told(m->last.figures, m->last.figure_count));
}

json_t *figures_frame(const struct frame_info *frame)
{
    return json_pack("{s:o, s:I, s:b, s:b, s:o*}", "frame_ms", json_number(frame->frame_ms), "shadow_bytes",
                     (json_int_t)frame->shadow_bytes, "prepared", frame->prepared, "converged", frame->converged, "figures",
                     figures_told(frame->figures, frame->figure_count));
}

json_t *figures_errors(const struct metrics *m)
{
    return json_pack(
        "{s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:I, s:I, s:{s:I, s:o, s:o, s:o, s:o}}", "receivers", (json_int_t)m->receivers,
        "misclassified", (json_int_t)m->misclassified, "misclassified_fraction", json_number(m->misclassified_fraction), "rmse",
        json_number(m->rmse), "max_abs", json_number(m->max_abs), "rmse_one_receiver", json_number(m->rmse_one_receiver),
        "wrong_samples", m->wrong_samples < 0 ? json_null() : json_integer((json_int_t)m->wrong_samples), "leaks",
        (json_int_t)m->leaks, "acne", (json_int_t)m->acne, "boundary", "pixels", (json_int_t)m->boundary.pixels, "rmse",
        json_number(m->boundary.rmse), "edge_shift_mean", json_number(m->boundary.edge_shift_mean), "edge_shift_p95",
        json_number(m->boundary.edge_shift_p95), "edge_shift_max", json_number(m->boundary.edge_shift_max));
}
