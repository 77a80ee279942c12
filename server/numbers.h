/* Numbers as users write them. Everything is checked to its last character: "10px" is not ten. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/dmath.h"

struct error;

/* A finite decimal number in [min, max] and nothing after it. */
bool number_parse(const char *text, double min, double max, double *out);
/* Decimal digits only, in [min, max]. */
bool number_parse_unsigned(const char *text, unsigned long min, unsigned long max, unsigned long *out);
/* `count` finite numbers separated by commas. */
bool number_parse_list(const char *text, double *out, size_t count);
/* "WxH", both in [1, limit]. Error: ERROR_USAGE. */
bool number_parse_size(const char *text, uint32_t limit, uint32_t *width, uint32_t *height, struct error *err);
/* "x,y,z". Error: ERROR_USAGE. */
bool number_parse_point(const char *text, struct dvec3 *out, struct error *err);
/* Index of `text` in the NULL-terminated `names`, or -1. */
int name_index(const char *const *names, const char *text);
/* "a, b or c" into `out`. */
void name_list(const char *const *names, char *out, size_t size);
