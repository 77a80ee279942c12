/* The figures of a suite, from what was shot during the run. */
#pragma once

#include <stdint.h>

struct bench_report;
struct bench_shot;
struct bench_shots;

/* Appends to report->pictures, figure by figure. What cannot be made is left out. */
void bench_pictures_make(struct bench_report *report, const struct bench_shots *shots);

/* A part of a picture. */
struct crop {
    uint32_t x, y, width, height;
};

/* The part of at most that size in which most pixels of the shot are misclassified: the upper left one of those. */
struct crop crop_most_wrong(const struct bench_shot *shot, uint32_t width, uint32_t height);
