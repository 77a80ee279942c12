#include "shadow/geometry/conservative.h"

/* Half of a row at a time: what any machine has in a vector. */
typedef float half_float __attribute__((vector_size(16)));
typedef int32_t half_int __attribute__((vector_size(16)));
typedef int64_t half_long __attribute__((vector_size(16)));

static inline unsigned touched_half(const struct conservative *t, float x, float y)
{
    half_float columns = (half_float){0, 1, 2, 3} + x;
    half_int touched = (columns >= (float)t->x0) & (columns <= (float)t->x1) & (half_int){1, 2, 4, 8};
    for (int k = 0; k < 3; k++)
        touched &= t->a[k] * columns + (t->b[k] * y + t->c[k]) >= -t->reach[k];
    int64_t both = ((half_long)touched)[0] | ((half_long)touched)[1];
    return (unsigned)(both | both >> 32);
}

unsigned conservative_row(const struct conservative *t, int32_t x, int32_t y)
{
    if (y < t->y0 || y > t->y1)
        return 0;
    unsigned low = touched_half(t, (float)x, (float)y);
    return t->x1 < x + 4 ? low : low | touched_half(t, (float)(x + 4), (float)y) << 4;
}

bool conservative_touches(const float px[3], const float py[3], float x, float y)
{
    float wx[3], wy[3];
    struct conservative t;
    for (int k = 0; k < 3; k++) {
        wx[k] = px[k] - x;
        wy[k] = py[k] - y;
    }
    return conservative_setup(&t, wx, wy, 1, 1) && (conservative_row(&t, 0, 0) & 1);
}
