/* JPEG for streams: libjpeg-turbo. One encoder per thread; it keeps its scratch memory between frames. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct jpeg_encoder;

struct jpeg_encoder *jpeg_encoder_create(struct error *err);
void jpeg_encoder_destroy(struct jpeg_encoder *encoder); /* accepts NULL */

/* Encodes RGBA rows, top to bottom and tightly packed; alpha is ignored. `quality` 1..100. *out belongs to the encoder and lasts until
 * its next call. */
bool jpeg_encode(struct jpeg_encoder *encoder, const uint8_t *rgba, uint32_t width, uint32_t height, int quality,
                 const uint8_t **out, size_t *size, struct error *err);
