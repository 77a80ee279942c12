/* Flicker of the stage's system while its lights or its camera turn slowly (reference/flicker.h). */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "renderer.h"

struct against;
struct reference;
struct reference_progress;
struct stage;

enum flicker_motion { FLICKER_LIGHT, FLICKER_CAMERA, FLICKER_MOTIONS };
extern const char *const flicker_motion_names[]; /* "light", "camera", NULL */

struct flicker_figures {
    unsigned frames;   /* 0: not measured */
    uint64_t count;    /* pixels times triples of frames, over all lights */
    double tested;     /* mean |V(t+1) - 2 V(t) + V(t-1)| of the system ... */
    double reference;  /* ... and of the reference */
    double difference; /* what the system adds: tested - reference */
};

enum { FLICKER_FRAMES_MIN = 3, FLICKER_FRAMES_DEFAULT = 16, FLICKER_FRAMES_MAX = 10000 };

/* `frames` pictures at one sample, FLICKER_STEP_DEG further each, about the vertical axis through the scene's centre: the lights turn before a
 * standing camera, or the camera before standing lights. A progressive system starts converged and then has one frame for each. Truth is
 * `against`: point or samples32 (else ERROR_USAGE). On the renderer's thread. `reference`: of the stage's scene; NULL: one is made.
 * `progress` may be NULL. */
#define FLICKER_STEP_DEG 0.05
bool flicker_measure(struct stage *stage, const struct against *against, enum flicker_motion motion, unsigned frames,
                     const struct reference *reference, const struct reference_progress *progress, struct flicker_figures *out,
                     struct error *err);
