/* The sections of the page, in its order. Each writes nothing when it has nothing to show. */
#pragma once

#include <stdio.h>

#include "report.h"

void html_put_summary(const struct bench_report *report, FILE *out); /* findings, at a glance, goals */
void html_put_fronts(const struct bench_report *report, FILE *out);  /* time against error */
void html_put_shares(const struct bench_report *report, FILE *out);  /* passes and memory */
void html_put_scaling(const struct bench_report *report, FILE *out);
void html_put_figures(const struct bench_report *report, FILE *out);
void html_put_tables(const struct bench_report *report, FILE *out);

/* Whether any cell of the table was run or failed. */
bool html_table_has_rows(const struct bench_plan *plan, unsigned table);
