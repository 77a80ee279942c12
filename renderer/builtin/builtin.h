/* Procedural scenes that need no file. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "scene/scene.h"

struct error;

struct builtin_param {
    const char *name, *help;
    double min, max, initial;
    bool whole; /* only whole numbers are accepted */
};

struct builtin_desc {
    const char *name;                   /* "box", "hard-04-contact" */
    const char *help;                   /* one sentence */
    const struct builtin_param *params; /* ended by name = NULL; may be NULL */
};

/* Sorted as they should be listed. */
extern const struct builtin_desc *const builtin_list[];
extern const size_t builtin_count;

/* `name` without "builtin:", with parameters: "dragon:triangles=100000". The result is finished. Errors (ERROR_NO_INPUT: no such
 * scene; ERROR_USAGE: its parameters) list what would be accepted. The same name gives the same bits every time. */
struct scene *builtin_make(const char *name, struct error *err);
