/* Files in and out. The only C++ of the project is behind this header: exceptions and std:: types stop at its .cc files. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"

struct error;

/* What `gnomon check` tells of a file beside the scene itself. Warnings: things read past (unknown extensions, a primitive of points ...),
 * one sentence each. */
struct import_report {
    char (*warnings)[256]; /* owned: free() */
    size_t warning_count;
};

/* Loads and validates a .gltf or .glb. Everything that the file names must lie in its own folder. `report` may be NULL. The result is
 * finished. NULL with err: ERROR_NO_INPUT, ERROR_DATA, ERROR_IO. */
struct scene *import_gltf(const char *path, struct import_report *report, struct error *err);

/* Same, from memory: for the fuzzer. Files it names are refused. */
struct scene *import_gltf_memory(const uint8_t *data, size_t size, struct import_report *report, struct error *err);

/* Decodes PNG/JPEG/WebP bytes to 8-bit RGBA; `what` names them in errors. Sizes are checked before anything is decoded: at most
 * 16384 a side. */
bool image_decode(const uint8_t *data, size_t size, const char *what, struct image *out, struct error *err);

enum image_format { IMAGE_PNG, IMAGE_JPEG, IMAGE_WEBP, IMAGE_EXR };

/* By the name's extension; false if it is none of the four. */
bool image_format_from_name(const char *name, enum image_format *out);

struct image_metadata {
    const char *key, *value;
};

/* Encodes pixels (rows top to bottom, tightly packed): rgba8 for PNG, JPEG, WebP, rgba32f for EXR. `quality` 1..100 for JPEG and
 * WebP. `out` is malloc'd: the caller frees. Metadata is written where the format can hold it (EXR attributes, PNG text). Thread-safe. */
bool image_encode(enum image_format format, const void *pixels, uint32_t width, uint32_t height, int quality,
                  const struct image_metadata *metadata, size_t metadata_count, uint8_t **out, size_t *size, struct error *err);

/* image_encode() to a file: a temporary name `.NAME.tmp-PID` beside it, fsync, rename. "-" is standard output. */
bool image_write(const char *path, enum image_format format, const void *pixels, uint32_t width, uint32_t height, int quality,
                 const struct image_metadata *metadata, size_t metadata_count, struct error *err);

/* The same for a picture that is encoded already. */
bool image_write_bytes(const char *path, const uint8_t *data, size_t size, struct error *err);
