#include "report.h"

#include <stdlib.h>

void bench_report_finish(struct bench_report *report)
{
    for (size_t i = 0; i < report->pictures.count; i++)
        free(report->pictures.data[i].data);
    array_finish(&report->pictures);
    bench_plan_finish(&report->plan);
}
