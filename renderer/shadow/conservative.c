#include "shadow/conservative.h"

unsigned conservative_row(const struct conservative *t, int32_t x, int32_t y)
{
    if (y < t->y0 || y > t->y1)
        return 0;
    lanes_float columns = LANES_COUNT + (float)x, edge[3];
    for (int k = 0; k < 3; k++)
        edge[k] = CONSERVATIVE_EDGE(t, k, columns, y);
    lanes_int touched = CONSERVATIVE_TOUCHED(t, edge, columns);
    unsigned bits = 0;
    for (int i = 0; i < CONSERVATIVE_LANES; i++)
        bits |= touched[i] ? 1u << i : 0;
    return bits;
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
