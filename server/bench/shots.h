/* What the pictures of a report are made of: full frames, kept until the run is over. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "base/array.h"

struct bench_cell;
struct comparison;

/* The cell's picture and the visibility of its first light, against point. Everything is owned. */
struct bench_shot {
    const struct bench_cell *cell;
    uint32_t width, height;
    uint8_t *rgba;
    float *tested, *truth;
    uint8_t *receiver;
};

struct bench_shots {
    ARRAY(struct bench_shot) list;
};

/* Copies from `c`; without memory there is no shot. */
void bench_shots_take(struct bench_shots *shots, const struct bench_cell *cell, const struct comparison *c);
void bench_shots_finish(struct bench_shots *shots);
