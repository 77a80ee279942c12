#include "turns.h"

#include <stdbool.h>
#include <stdlib.h>

/* Bresenham's even spread: `count` of `rounds` rounds, the last one among them. */
static bool takes_part(uint64_t round, uint64_t count, uint64_t rounds)
{
    return (round + 1) * count / rounds > round * count / rounds;
}

struct turn *turns_order(const unsigned *counts, size_t cells, size_t *total)
{
    unsigned rounds = 0;
    *total = 0;
    for (size_t i = 0; i < cells; i++) {
        rounds = counts[i] > rounds ? counts[i] : rounds;
        *total += counts[i];
    }
    struct turn *order = *total ? calloc(*total, sizeof *order) : NULL;
    size_t n = 0;
    for (uint32_t round = 0; order && round < rounds; round++)
        for (size_t i = 0; i < cells; i++)
            if (takes_part(round, counts[i], rounds))
                order[n++] = (struct turn){round, (uint32_t)i};
    return order;
}
