/* Names of numbered pictures: "out/frame.####.exr". */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* `pattern` with the last run of # in its file name replaced by `frame`, padded with zeros to the run's length, into `out`. False when
 * there is no #, or no room. */
bool frame_name(const char *pattern, unsigned frame, char *out, size_t size);
