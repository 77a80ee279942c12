/* The picture of a comparison: where the tested visibility is wrong, and which way. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "import/import.h"

struct against;
struct comparison;
struct stage;

/* Over a grey, darkened copy of the picture: orange where a pixel is too bright (a leak), blue where it is too dark (acne), the stronger the
 * larger |V - Vref|, of the light with the largest. `rgba8`: width * height * 4. */
void difference_paint(const struct comparison *c, uint8_t *rgba8);

/* The numbers of the same light: R = V, G = Vref, B = V - Vref, A = 1 where the pixel counts. `rgba32f`: width * height * 4. */
void difference_numbers(const struct comparison *c, float *rgba32f);

/* One of the two to a file, as the format is: numbers for EXR. */
bool difference_write(const struct comparison *c, const struct stage *stage, const struct against *against, const char *path,
                      enum image_format format, struct error *err);
