#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "html.h"
#include "html_sections.h"
#include "plot.h"
#include "series.h"

static const char *const axis_labels[] = {
    [AXIS_NONE] = "",
    [AXIS_TRIANGLES] = "triangles drawn",
    [AXIS_MAP_SIZE] = "side of the map, texels",
    [AXIS_PIXELS] = "pixels",
    [AXIS_LIGHTS] = "lights",
};

static double place(const struct bench_plan *plan, const struct bench_cell *cell, enum table_axis axis)
{
    const struct bench_setup *s = &plan->setups.data[cell->setup];
    switch (axis) {
    case AXIS_TRIANGLES: return (double)s->drawn_triangles;
    case AXIS_MAP_SIZE: return cell->map_size;
    case AXIS_PIXELS: return (double)s->width * s->height;
    case AXIS_LIGHTS: return s->lights;
    case AXIS_NONE: break;
    }
    return NAN;
}

static int compare_points(const void *a, const void *b)
{
    const struct plot_point *x = a, *y = b;
    if (x->line != y->line)
        return x->line < y->line ? -1 : 1;
    return (x->x > y->x) - (x->x < y->x);
}

/* The name goes to the last point of each line. */
static void name_ends(struct plot_point *points, size_t count)
{
    for (size_t i = 0; i + 1 < count; i++)
        if (points[i].line == points[i + 1].line)
            points[i].name[0] = 0;
}

static void put_curves(const struct bench_plan *plan, unsigned index, int regime, FILE *out)
{
    const struct bench_table *table = plan->suite->tables[index];
    struct plot_point *points = calloc(plan->cells.count, sizeof *points);
    size_t count = 0;
    for (size_t i = 0; points && i < plan->cells.count; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        if (!(c->tables & 1u << index) || !c->times[regime].measured)
            continue;
        struct plot_point *p = &points[count++];
        struct series s = series_of(c->times[regime].frame_ms, c->times[regime].rounds);
        *p = (struct plot_point){.x = place(plan, c, table->axis), .y = s.median, .color = html_color(c->system)};
        p->line = p->color + 1;
        snprintf(p->name, sizeof p->name, "%s", c->system->name);
        snprintf(p->hover, sizeof p->hover, "%s at %.9g %s: %.2f ms (quartiles %.2f to %.2f)", c->name, p->x,
                 axis_labels[table->axis], s.median, s.q1, s.q3);
    }
    if (count) {
        char title[200];
        snprintf(title, sizeof title, "%s, light %s", table->title, bench_regime_names[regime]);
        qsort(points, count, sizeof *points, compare_points);
        name_ends(points, count);
        const struct plot plot = {title, axis_labels[table->axis], "median frame, ms", true, true, points, count};
        plot_put(&plot, out);
    }
    free(points);
}

void html_put_scaling(const struct bench_report *report, FILE *out)
{
    const struct bench_plan *plan = &report->plan;
    bool begun = false;
    for (unsigned t = 0; plan->suite->tables[t]; t++) {
        if (plan->suite->tables[t]->shape != SHAPE_SCALING || !html_table_has_rows(plan, t))
            continue;
        if (!begun)
            fputs(
                "<section id=scaling><h2>How cost grows</h2><p class=note>Both axes logarithmic: a straight line at 45 degrees is proportional.</p>"
                "<div class=plots>\n",
                out);
        begun = true;
        for (int r = 0; r < REGIME_COUNT; r++)
            put_curves(plan, t, r, out);
    }
    if (begun)
        fputs("</div></section>\n", out);
}
