#include <string.h>

#include "list.h"

const struct bench_suite *const bench_suites[] = {&bench_suite_smoke, &bench_suite_paper, &bench_suite_hard, &bench_suite_full,
                                                  NULL};

const struct bench_suite *bench_suite_find(const char *name)
{
    for (size_t i = 0; bench_suites[i]; i++)
        if (!strcmp(bench_suites[i]->name, name))
            return bench_suites[i];
    return NULL;
}
