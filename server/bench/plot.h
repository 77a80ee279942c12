/* Charts as inline SVG: they need no script and take their colours from the page. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct plot_point {
    double x, y;
    unsigned color;  /* html_color() */
    char name[64];   /* short, beside the point where there is room; "" for none */
    char hover[300]; /* told when pointed at */
    bool on_front;   /* of the Pareto front */
    size_t line;     /* points of one line are joined in the order given; 0: none */
};

struct plot {
    const char *title, *x_label, *y_label;
    bool x_log, y_log; /* zeros of a logarithmic y lie on a line of their own below */
    const struct plot_point *points;
    size_t count;
};

/* Points that are not numbers are left out; nothing at all is written when none is left. */
void plot_put(const struct plot *plot, FILE *out);

/* A row of a bar chart: segments one after the other. */
struct plot_bar {
    char name[64];
    double values[8];
};

/* Horizontal stacked bars; `parts` are the segments' names, at most 8. */
void plot_put_bars(const char *title, const char *unit, const char *const *parts, size_t part_count, const struct plot_bar *bars,
                   size_t count, FILE *out);
