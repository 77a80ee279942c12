/* The Pareto front of cost against error. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct front_point {
    double cost, error; /* smaller is better; NAN: not measured */
};

/* on_front[i]: no other point is at least as good in both and better in one. Equal points are on it together; a point with a NAN never
 * is, and beats none. */
void front_mark(const struct front_point *points, size_t count, bool *on_front);
