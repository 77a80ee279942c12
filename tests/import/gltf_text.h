/* Small glTF files made in memory: JSON around one base64 buffer. */
#pragma once

#include <assert.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "import/import.h"

static inline void base64(const uint8_t *data, size_t size, char *out)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        uint32_t bits =
            (uint32_t)data[i] << 16 | (i + 1 < size ? (uint32_t)data[i + 1] << 8 : 0) | (i + 2 < size ? data[i + 2] : 0);
        for (int k = 0; k < 4; k++)
            *out++ = i + (size_t)k <= size ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    *out = 0;
}

/* `members`: the file's members but asset and buffers. The caller frees. */
static inline char *gltf_text(const char *members, const void *data, size_t size)
{
    size_t room = strlen(members) + size / 3 * 4 + 300;
    char *text = malloc(room), *code = malloc(size / 3 * 4 + 8);
    if (!text || !code)
        abort();
    base64(data, size, code);
    snprintf(text, room, "{\"asset\":{\"version\":\"2.0\"},%s,\"buffers\":[{\"byteLength\":%zu,\"uri\":\"data:;base64,%s\"}]}",
             members, size, code);
    free(code);
    return text;
}

static inline struct scene *gltf_try(const char *members, const void *data, size_t size, struct error *err)
{
    char *text = gltf_text(members, data, size);
    struct scene *scene = import_gltf_memory((const uint8_t *)text, strlen(text), NULL, err);
    free(text);
    return scene;
}

/* Must load. */
static inline struct scene *gltf_make(const char *members, const void *data, size_t size)
{
    struct error err = {0};
    struct scene *scene = gltf_try(members, data, size, &err);
    if (!scene) {
        fprintf(stderr, "%s\n", err.message);
        abort();
    }
    return scene;
}

/* Must be refused with ERROR_DATA and a sentence that holds `part`. */
static inline void gltf_refused(const char *members, const void *data, size_t size, const char *part)
{
    struct error err = {0};
    struct scene *scene = gltf_try(members, data, size, &err);
    if (scene || err.code != ERROR_DATA || !strstr(err.message, part)) {
        fprintf(stderr, "%s: wanted \"%s\"\n", scene ? "loaded" : err.message, part);
        abort();
    }
}
