/* One picture's visibility held against a reference, light by light. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "against.h"
#include "reference/metrics.h"
#include "reference/reference.h"
#include "renderer.h"

struct stage;

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

/* The device's share: renders the stage's settings once at one sample a pixel, and the system that is taken for true, and reads visibility
 * back. On the renderer's thread. The caller finishes `out` whatever this returns. */
bool comparison_render(struct stage *stage, const struct against *against, struct comparison *out, struct error *err);
/* The rest: traces the reference and measures. Any thread; the stage's renderer is not used. `progress` may be NULL. */
bool comparison_trace(const struct stage *stage, const struct against *against, const struct reference_progress *progress,
                      struct comparison *c, struct error *err);
void comparison_finish(struct comparison *c);
