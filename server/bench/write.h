/* The writers: each turns a report into one format and reads nothing else. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include <jansson.h>

#include "report.h"

struct error;

/* The caller owns the object; NULL when memory is out. */
json_t *bench_json(const struct bench_report *report);
/* A line a cell, for spreadsheets (RFC 4180, a header first). */
void bench_csv(const struct bench_report *report, FILE *out);
/* Tables for a terminal. */
void bench_text(const struct bench_report *report, FILE *out);
/* One page that needs nothing else. */
void bench_html(const struct bench_report *report, FILE *out);
