#include "shadow/mask/mask_table.h"

#include "scene/view.h"

/* One line's true mask. */
static uint32_t samples_beyond(double c, double x, double y)
{
    uint32_t mask = 0;
    for (int i = 0; i < 32; i++)
        if (c + x * ((double)view_samples32[i][0] - 0.5) + y * ((double)view_samples32[i][1] - 0.5) > 0)
            mask |= 1u << i;
    return mask;
}

/* Over a lattice that has no part in the cells' own: 251 directions, 241 offsets. */
static double wrong_bits(const struct mask_table *t)
{
    uint64_t wrong = 0, count = 0;
    for (int i = 0; i < 2 * 251; i++)
        for (int j = 0; j < 241; j++) {
            double y = (i % 251 + 0.5) * (2.0 / 251) - 1, x = i < 251 ? 1 - fabs(y) : fabs(y) - 1, c = (j + 0.5) / 241 - 0.5;
            wrong += (unsigned)__builtin_popcount(mask_table_look(t, (float)c, (float)x, (float)y) ^ samples_beyond(c, x, y));
            count += 32;
        }
    return (double)wrong / (double)count;
}

void mask_table_fill(struct mask_table *t)
{
    for (int i = 0; i < 2 * MASK_DIRECTIONS; i++)
        for (int j = 0; j < MASK_OFFSETS; j++) {
            double y = (i % MASK_DIRECTIONS + 0.5) * (2.0 / MASK_DIRECTIONS) - 1;
            double x = i < MASK_DIRECTIONS ? 1 - fabs(y) : fabs(y) - 1;
            t->bits[i][j] = samples_beyond((j + 0.5) / MASK_OFFSETS - 0.5, x, y);
        }
    t->wrong = wrong_bits(t);
}
