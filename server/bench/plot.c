#include "plot.h"

#include <math.h>
#include <string.h>

#include "html.h"

/* The drawing in units of its viewBox. */
enum { WIDTH = 620, HEIGHT = 390, LEFT = 62, RIGHT = 14, TOP = 34, BOTTOM = 46, ZERO_BAND = 22 };
enum { TICKS_MAX = 40, LABELS_MAX = 60 };

struct axis {
    double from, to;   /* of the data; logarithms when log */
    double start, end; /* of the drawing */
    bool log;
};

static double axis_place(const struct axis *a, double value)
{
    double v = a->log ? log10(value) : value;
    return a->start + (v - a->from) / (a->to - a->from) * (a->end - a->start);
}

static bool shown(const struct plot *plot, const struct plot_point *p)
{
    return isfinite(p->x) && isfinite(p->y) && (!plot->x_log || p->x > 0) && p->y >= 0;
}

static bool has_zeros(const struct plot *plot)
{
    for (size_t i = 0; i < plot->count; i++)
        if (plot->y_log && shown(plot, &plot->points[i]) && plot->points[i].y == 0)
            return true;
    return false;
}

static struct axis fit_axis(const struct plot *plot, bool vertical)
{
    struct axis a = {.from = INFINITY, .to = -INFINITY, .log = vertical ? plot->y_log : plot->x_log};
    for (size_t i = 0; i < plot->count; i++) {
        double v = vertical ? plot->points[i].y : plot->points[i].x;
        if (!shown(plot, &plot->points[i]) || (a.log && v <= 0))
            continue;
        v = a.log ? log10(v) : v;
        a.from = fmin(a.from, v);
        a.to = fmax(a.to, v);
    }
    if (!(a.from <= a.to)) /* zeros only */
        a.from = a.to = a.log ? -4 : 0;
    double room = fmax(0.06 * (a.to - a.from), a.log ? 0.08 : 1e-9);
    a.from -= a.log ? room : fmin(room, a.from);
    a.to += room;
    a.start = vertical ? HEIGHT - BOTTOM - (has_zeros(plot) ? ZERO_BAND : 0) : LEFT;
    a.end = vertical ? TOP : WIDTH - RIGHT;
    return a;
}

/* 1, 2, 5 of each decade; only the decades' own where there are many. */
static size_t log_ticks(const struct axis *a, double ticks[TICKS_MAX])
{
    static const double steps[] = {1, 2, 5};
    size_t count = 0;
    for (int decade = (int)floor(a->from); decade <= (int)ceil(a->to); decade++)
        for (int i = 0; i < 3 && count < TICKS_MAX; i++) {
            double t = steps[i] * pow(10, decade);
            if ((a->to - a->from < 2.2 || i == 0) && log10(t) >= a->from && log10(t) <= a->to)
                ticks[count++] = t;
        }
    return count;
}

static size_t linear_ticks(const struct axis *a, double ticks[TICKS_MAX])
{
    double rough = (a->to - a->from) / 6, unit = pow(10, floor(log10(rough))), step = unit;
    size_t count = 0;
    step = rough / unit > 5 ? 10 * unit : rough / unit > 2 ? 5 * unit : rough / unit > 1 ? 2 * unit : unit;
    for (double t = ceil(a->from / step) * step; t <= a->to && count < TICKS_MAX; t += step)
        ticks[count++] = fabs(t) < step * 1e-9 ? 0 : t;
    return count;
}

static void put_tick(FILE *out, double value)
{
    if (value >= 1e6)
        fprintf(out, "%.3g M", value * 1e-6);
    else if (value >= 1e4)
        fprintf(out, "%.3g k", value * 1e-3);
    else if (value != 0 && value < 1e-3)
        fprintf(out, "%.0e", value);
    else
        fprintf(out, "%.4g", value);
}

static void put_grid(const struct plot *plot, const struct axis *x, const struct axis *y, FILE *out)
{
    double ticks[TICKS_MAX];
    size_t count = x->log ? log_ticks(x, ticks) : linear_ticks(x, ticks);
    for (size_t i = 0; i < count; i++) {
        double at = axis_place(x, ticks[i]);
        fprintf(
            out,
            "<line class=grid x1=\"%.1f\" x2=\"%.1f\" y1=\"%d\" y2=\"%d\"/><text class=tick x=\"%.1f\" y=\"%d\" text-anchor=middle>",
            at, at, TOP, HEIGHT - BOTTOM, at, HEIGHT - BOTTOM + 15);
        put_tick(out, ticks[i]);
        fputs("</text>", out);
    }
    count = y->log ? log_ticks(y, ticks) : linear_ticks(y, ticks);
    for (size_t i = 0; i < count; i++) {
        double at = axis_place(y, ticks[i]);
        fprintf(
            out,
            "<line class=grid x1=\"%d\" x2=\"%d\" y1=\"%.1f\" y2=\"%.1f\"/><text class=tick x=\"%d\" y=\"%.1f\" text-anchor=end>",
            LEFT, WIDTH - RIGHT, at, at, LEFT - 6, at + 4);
        put_tick(out, ticks[i]);
        fputs("</text>", out);
    }
    if (has_zeros(plot))
        fprintf(
            out,
            "<line class=zero x1=\"%d\" x2=\"%d\" y1=\"%d\" y2=\"%d\"/><text class=tick x=\"%d\" y=\"%d\" text-anchor=end>0</text>",
            LEFT, WIDTH - RIGHT, HEIGHT - BOTTOM, HEIGHT - BOTTOM, LEFT - 6, HEIGHT - BOTTOM + 4);
}

static void put_frame(const struct plot *plot, FILE *out)
{
    fputs("<text class=title x=\"6\" y=\"18\">", out);
    html_put_text(out, plot->title);
    fprintf(out, "</text><text class=axis x=\"%d\" y=\"%d\" text-anchor=middle>", (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8);
    html_put_text(out, plot->x_label);
    fprintf(out, "</text><text class=axis transform=\"translate(13 %d) rotate(-90)\" text-anchor=middle>",
            (TOP + HEIGHT - BOTTOM) / 2);
    html_put_text(out, plot->y_label);
    fputs("</text>", out);
}

static double place_y(const struct axis *y, const struct plot_point *p)
{
    return y->log && p->y == 0 ? HEIGHT - BOTTOM : axis_place(y, p->y);
}

static void put_lines(const struct plot *plot, const struct axis *x, const struct axis *y, FILE *out)
{
    for (size_t i = 0; i + 1 < plot->count; i++) {
        const struct plot_point *a = &plot->points[i], *b = NULL;
        for (size_t k = i + 1; a->line && !b && k < plot->count; k++)
            if (plot->points[k].line == a->line && shown(plot, &plot->points[k]))
                b = &plot->points[k];
        if (b && shown(plot, a))
            fprintf(out, "<line class=\"curve c%u\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>", a->color,
                    axis_place(x, a->x), place_y(y, a), axis_place(x, b->x), place_y(y, b));
    }
}

/* The front as a staircase: right of and above each of its points something is better. */
static void put_front(const struct plot *plot, const struct axis *x, const struct axis *y, FILE *out)
{
    double at = -1, height = 0;
    bool first = true;
    for (;;) {
        const struct plot_point *next = NULL;
        for (size_t i = 0; i < plot->count; i++) {
            const struct plot_point *p = &plot->points[i];
            if (p->on_front && shown(plot, p) && p->x > at && (!next || p->x < next->x))
                next = p;
        }
        if (!next)
            break;
        if (first)
            fputs("<path class=front d=\"", out);
        else
            fprintf(out, "L%.1f %.1f ", axis_place(x, next->x), height);
        height = place_y(y, next);
        fprintf(out, "%c%.1f %.1f ", first ? 'M' : 'L', axis_place(x, next->x), height);
        first = false;
        at = next->x;
    }
    if (!first)
        fprintf(out, "L%d %.1f\"/>", WIDTH - RIGHT, height);
}

struct box {
    double x, y, width, height;
};

static bool overlaps(const struct box *a, const struct box *b)
{
    return a->x < b->x + b->width && b->x < a->x + a->width && a->y < b->y + b->height && b->y < a->y + a->height;
}

static bool is_free(const struct box *b, const struct box *taken, size_t count)
{
    bool inside = b->x >= LEFT && b->x + b->width <= WIDTH - 2 && b->y >= TOP - 10 && b->y + b->height <= HEIGHT - BOTTOM + 12;
    for (size_t i = 0; inside && i < count; i++)
        inside = !overlaps(b, &taken[i]);
    return inside;
}

static const double CHARACTER = 6.1; /* width of one of a label's, about */

/* Beside its point where nothing is yet: right, left, above, below. */
static bool put_name(const struct plot_point *p, double x, double y, struct box *taken, size_t *count, FILE *out)
{
    double width = CHARACTER * (double)strlen(p->name);
    const struct box tries[] = {{x + 8, y - 7, width, 13},
                                {x - 8 - width, y - 7, width, 13},
                                {x - width / 2, y - 21, width, 13},
                                {x - width / 2, y + 8, width, 13}};
    for (size_t i = 0; i < 4 && *count < LABELS_MAX; i++) {
        if (!is_free(&tries[i], taken, *count))
            continue;
        taken[(*count)++] = tries[i];
        fprintf(out, "<text class=name x=\"%.1f\" y=\"%.1f\">", tries[i].x, tries[i].y + 11);
        html_put_text(out, p->name);
        fputs("</text>", out);
        return true;
    }
    return false;
}

static void put_point(const struct plot_point *p, double x, double y, FILE *out)
{
    fprintf(out, "<g class=\"point c%u%s\">", p->color, p->on_front ? " best" : "");
    fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%s\"/><title>", x, y, p->on_front ? "5.5" : "4");
    html_put_text(out, p->hover);
    fputs("</title></g>", out);
}

static void put_points(const struct plot *plot, const struct axis *x, const struct axis *y, FILE *out)
{
    struct box taken[2 * LABELS_MAX];
    size_t count = 0;
    for (size_t i = 0; i < plot->count; i++) {
        const struct plot_point *p = &plot->points[i];
        if (!shown(plot, p))
            continue;
        double px = axis_place(x, p->x), py = place_y(y, p);
        put_point(p, px, py, out);
        if (count < LABELS_MAX - 10)
            taken[count++] = (struct box){px - 5, py - 5, 10, 10};
    }
    /* Those of the front first. */
    for (int front = 1; front >= 0; front--)
        for (size_t i = 0; i < plot->count; i++) {
            const struct plot_point *p = &plot->points[i];
            if (p->name[0] && p->on_front == (front == 1) && shown(plot, p))
                put_name(p, axis_place(x, p->x), place_y(y, p), taken, &count, out);
        }
}

void plot_put(const struct plot *plot, FILE *out)
{
    size_t visible = 0;
    for (size_t i = 0; i < plot->count; i++)
        visible += shown(plot, &plot->points[i]);
    if (!visible)
        return;
    struct axis x = fit_axis(plot, false), y = fit_axis(plot, true);
    fprintf(out, "<svg class=plot viewBox=\"0 0 %d %d\" role=img>", WIDTH, HEIGHT);
    put_frame(plot, out);
    put_grid(plot, &x, &y, out);
    put_front(plot, &x, &y, out);
    put_lines(plot, &x, &y, out);
    put_points(plot, &x, &y, out);
    fputs("</svg>\n", out);
}

enum { BAR_LEFT = 205, BAR_ROW = 21, BAR_TOP = 30, PARTS_MAX = 8 };

static double bar_sum(const struct plot_bar *bar, size_t parts)
{
    double sum = 0;
    for (size_t i = 0; i < parts; i++)
        sum += isfinite(bar->values[i]) ? bar->values[i] : 0;
    return sum;
}

static void put_bar(const struct plot_bar *bar, const char *unit, const char *const *parts, size_t part_count, double scale,
                    double y, FILE *out)
{
    double x = BAR_LEFT;
    fprintf(out, "<text class=name x=\"%d\" y=\"%.1f\" text-anchor=end>", BAR_LEFT - 8, y + 13);
    html_put_text(out, bar->name);
    fputs("</text>", out);
    for (size_t i = 0; i < part_count; i++) {
        double width = isfinite(bar->values[i]) ? bar->values[i] * scale : 0;
        fprintf(out,
                "<rect class=\"part p%zu\" x=\"%.1f\" y=\"%.1f\" width=\"%.2f\" height=\"15\"><title>%s: %.3g %s</title></rect>",
                i, x, y, width, parts[i], bar->values[i], unit);
        x += width;
    }
    fprintf(out, "<text class=tick x=\"%.1f\" y=\"%.1f\">%.3g</text>", x + 5, y + 12, bar_sum(bar, part_count));
}

void plot_put_bars(const char *title, const char *unit, const char *const *parts, size_t part_count, const struct plot_bar *bars,
                   size_t count, FILE *out)
{
    double most = 0;
    part_count = part_count < PARTS_MAX ? part_count : PARTS_MAX;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, bar_sum(&bars[i], part_count));
    if (!(most > 0))
        return;
    fprintf(out, "<svg class=plot viewBox=\"0 0 %d %zu\" role=img><text class=title x=\"6\" y=\"18\">", WIDTH,
            BAR_TOP + 6 + count * BAR_ROW);
    html_put_text(out, title);
    fputs("</text>", out);
    for (size_t i = 0; i < count; i++)
        put_bar(&bars[i], unit, parts, part_count, (WIDTH - BAR_LEFT - 55) / most, BAR_TOP + (double)(i * BAR_ROW), out);
    fputs("</svg>\n", out);
}
