/* One picture's visibility held against a reference, light by light. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "against.h"
#include "list_reading.h"
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
    uint8_t *receiver[RENDERER_LIGHTS_MAX];               /* 1 where the pixel counts */
    uint8_t *one_triangle;                                /* 1 where all 32 samples see the same triangle */
    struct sample_masks masks[RENDERER_LIGHTS_MAX];       /* tested, where the system decides each sample; else NULL */
    struct sample_masks truth_masks[RENDERER_LIGHTS_MAX]; /* of samples32; else NULL */
    int64_t wrong_samples[RENDERER_LIGHTS_MAX];           /* against samples32, of systems with masks; else -1 */
    struct shadow_figure figures[RENDERER_LIGHTS_MAX][SHADOW_FIGURES_MAX]; /* what the system tells of itself */
    size_t figure_count[RENDERER_LIGHTS_MAX];
    struct list_reading lists[RENDERER_LIGHTS_MAX];
    bool without_lists;       /* they are not taken */
    unsigned converge_frames; /* how many the tested picture took ... */
    bool converged;           /* ... and whether that was enough */
    struct metrics light[RENDERER_LIGHTS_MAX];
    struct metrics total;
    struct reference_counts counts; /* of the reference, over all lights */
    double frame_ms;                /* of the tested picture */
    double reference_ms;            /* wall time of its rays, without its tree */
    void *picture;                  /* the tested picture, RGBA8 */
};

/* The device's share: renders the stage's settings once at one sample a pixel, and the system that is taken for true, and reads visibility
 * back. On the renderer's thread. The caller finishes `out` whatever this returns. */
bool comparison_render(struct stage *stage, const struct against *against, struct comparison *out, struct error *err);
/* The rest: traces the reference and measures. Any thread; the stage's renderer is not used. `progress` may be NULL. */
bool comparison_trace(const struct stage *stage, const struct against *against, const struct reference_progress *progress,
                      struct comparison *c, struct error *err);
/* After that: the errors that lists of the `length` (1..ORACLE_LENGTH_MAX) most visible triangles a texel would have made, over the lights whose
 * system has lists; receivers 0 where there is none (reference/oracle.h). Any thread. */
bool comparison_oracle(const struct stage *stage, unsigned length, const struct reference_progress *progress,
                       const struct comparison *c, struct metrics *out, struct error *err);
/* Another system against the truth that `c` holds already: the stage's settings may differ from those of comparison_render() in system and
 * parameters only. Lists are taken against point alone. On the renderer's thread. */
bool comparison_repeat(struct stage *stage, const struct against *against, struct comparison *c, struct error *err);
void comparison_finish(struct comparison *c);
