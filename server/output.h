/* What commands write beside pictures: JSON to a file or to standard output ("-"). */
#pragma once

#include <stdbool.h>

#include <jansson.h>

struct error;

/* Writes `root` to `path`, indented, ended by a newline; takes the reference. NULL counts as memory out. ERROR_IO. */
bool output_json(const char *path, json_t *root, struct error *err);

/* Refuses (ERROR_IO) a path whose folder is missing or not writable: told before the work, not after it. */
bool output_check(const char *path, struct error *err);

/* Pushes out what stdio holds for standard output. ERROR_IO when a write to it failed, now or before. */
bool output_flush(struct error *err);

/* A string that a file gave: bytes that are not UTF-8 become '?'. */
json_t *json_text(const char *text);

/* null for NaN and infinity, which JSON does not have. */
json_t *json_number(double value);
