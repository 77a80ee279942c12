#include "front.h"

static bool beats(const struct front_point *a, const struct front_point *b)
{
    return a->cost <= b->cost && a->error <= b->error && (a->cost < b->cost || a->error < b->error);
}

void front_mark(const struct front_point *points, size_t count, bool *on_front)
{
    for (size_t i = 0; i < count; i++) {
        on_front[i] = points[i].cost == points[i].cost && points[i].error == points[i].error;
        for (size_t k = 0; on_front[i] && k < count; k++)
            on_front[i] = !beats(&points[k], &points[i]);
    }
}
