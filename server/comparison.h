/* One picture's visibility held against a reference, light by light. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "reference/metrics.h"
#include "reference/reference.h"
#include "renderer.h"

struct progress;
struct stage;

enum against_kind { AGAINST_POINT, AGAINST_SAMPLES32, AGAINST_SYSTEM };

/* What is taken for true. */
struct against {
    enum against_kind kind;
    const struct shadow_system *system; /* AGAINST_SYSTEM */
    struct shadow_params params;
};

/* "point", "samples32" or an algorithm with parameters. ERROR_USAGE. */
bool against_parse(const char *text, struct against *out, struct error *err);
/* The same back, every parameter written out. `out` holds at least 256 bytes. */
void against_format(const struct against *against, char *out, size_t size);

/* Everything is owned: comparison_finish(). Arrays hold width * height entries. */
struct comparison {
    uint32_t width, height;
    size_t light_count;
    uint32_t *ids;                      /* drawn triangles, as the camera pass wrote them */
    float *tested[RENDERER_LIGHTS_MAX]; /* visibility, [0,1] */
    float *truth[RENDERER_LIGHTS_MAX];
    uint8_t *receiver[RENDERER_LIGHTS_MAX]; /* 1 where the pixel counts */
    uint8_t *one_triangle;                  /* 1 where all 32 samples see the same triangle */
    struct metrics light[RENDERER_LIGHTS_MAX];
    struct metrics total;
    struct reference_counts counts; /* of the reference, over all lights */
    double reference_ms;            /* wall time of its rays, without its tree */
    void *picture;                  /* the tested picture, RGBA8 */
};

/* Renders the stage's settings once at one sample a pixel, reads visibility back, computes the reference and measures. The caller
 * finishes `out` whatever this returns. */
bool comparison_run(struct stage *stage, const struct against *against, struct progress *progress, struct comparison *out,
                    struct error *err);
void comparison_finish(struct comparison *c);
