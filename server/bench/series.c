#include "series.h"

#include <math.h>
#include <stdlib.h>

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double interpolated(const double *sorted, size_t count, double p)
{
    double at = p * (double)(count - 1);
    size_t below = (size_t)at, above = below + 1 < count ? below + 1 : below;
    return sorted[below] + (at - (double)below) * (sorted[above] - sorted[below]);
}

/* Sorts `values`. */
static struct series summarise(double *values, size_t count)
{
    if (count == 0)
        return (struct series){0, NAN, NAN, NAN, NAN, NAN};
    qsort(values, count, sizeof *values, compare_doubles);
    return (struct series){
        .count = count,
        .min = values[0],
        .q1 = interpolated(values, count, 0.25),
        .median = interpolated(values, count, 0.5),
        .q3 = interpolated(values, count, 0.75),
        .max = values[count - 1],
    };
}

static struct series summarise_quotients(const double *a, const double *b, size_t count)
{
    double *kept = count ? malloc(count * sizeof *kept) : NULL;
    size_t n = 0;
    for (size_t i = 0; kept && i < count; i++) {
        double value = b ? a[i] / b[i] : a[i];
        if (isfinite(value))
            kept[n++] = value;
    }
    struct series s = summarise(kept, n);
    free(kept);
    return s;
}

struct series series_of(const double *values, size_t count) { return summarise_quotients(values, NULL, count); }

struct series series_of_ratios(const double *a, const double *b, size_t count) { return summarise_quotients(a, b, count); }
