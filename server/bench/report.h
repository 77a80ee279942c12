/* A run's outcome: all that the writers get to see. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <time.h>

#include "plan.h"

/* One picture of a figure, encoded. */
struct bench_picture {
    size_t figure;     /* index in the suite's list */
    char caption[400]; /* what it shows */
    const char *media; /* "image/png" or "image/jpeg" */
    uint8_t *data;     /* owned */
    size_t size;
    uint32_t width, height;
};

struct bench_report {
    struct bench_plan plan;
    struct device_info device;
    unsigned threads;
    char processor[100]; /* as the kernel calls it, "" where it does not */
    char command[600];
    time_t started;
    double seconds;
    bool interrupted;
    ARRAY(struct bench_picture) pictures;
};

void bench_report_finish(struct bench_report *report);
