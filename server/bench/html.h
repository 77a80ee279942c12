/* Pieces of a page. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct shadow_system;

/* Text with what HTML would take for markup written out. */
void html_put_text(FILE *out, const char *text);

/* "data:MEDIA;base64,..." (RFC 2397). */
void html_put_data(FILE *out, const char *media, const uint8_t *data, size_t size);

/* Three significant digits; an en dash for what is not a number. */
void html_put_number(FILE *out, double value);

/* The number of the system's colour in report.css: its place in the registry. */
unsigned html_color(const struct shadow_system *system);

/* An algorithm without what goes without saying: "pass:size=1024,slope=2" is "pass 1024 slope=2". */
void html_short_name(const char *algorithm, char *out, size_t size);
