/* What a row of repeated measurements says. NAN entries were not measured and do not count. */
#pragma once

#include <stddef.h>

/* Quartiles by linear interpolation between the order statistics (Hyndman and Fan 1996, definition 7); all NAN when count is 0. */
struct series {
    size_t count;
    double min, q1, median, q3, max;
};

/* The result is all NAN too when memory is out. */
struct series series_of(const double *values, size_t count);

/* Of a[i] / b[i] where both were measured: what the two have in common, such as a busy machine, cancels. */
struct series series_of_ratios(const double *a, const double *b, size_t count);
