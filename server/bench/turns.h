/* In which order the cells of a batch take their turns: A B C A B C, so that a machine that slows down slows all of them. */
#pragma once

#include <stddef.h>
#include <stdint.h>

struct turn {
    uint32_t round; /* [0, the largest count) */
    uint32_t cell;
};

/* Cell i gets counts[i] turns. There are as many rounds as the largest count; a cell with fewer turns sits rounds out evenly. Within a
 * round the cells keep their order. The result is malloc'd, *total entries; NULL when memory is out or there are none. */
struct turn *turns_order(const unsigned *counts, size_t cells, size_t *total);
