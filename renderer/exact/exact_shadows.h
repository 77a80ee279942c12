/* Shadows equal to the reference's (docs/truth.md), sample for sample, found without tracing rays: docs/exact.md. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"
#include "scene/view.h"

struct error;
struct exact_shadows;
struct job_pool;

/* What one light's shadows need, whoever looks: depends on the scene and the light alone. `memory`: bytes it may take, 0: no limit; with less
 * it gets slower. ERROR_TRY_AGAIN when memory is out or `memory` too little. `scene` must outlive it. One thread at a time. */
struct exact_shadows *exact_shadows_create(const struct scene *scene, size_t memory, struct error *err);
void exact_shadows_destroy(struct exact_shadows *e);

/* Builds the light's grid. */
bool exact_shadows_set_light(struct exact_shadows *e, const struct light *light, struct job_pool *pool, struct error *err);

/* reference_point()'s visibility: ids as the camera pass wrote them. The result is the callee's, valid until the next call. */
const float *exact_shadows_point(struct exact_shadows *e, const struct view *view, const uint32_t *ids, struct job_pool *pool,
                                 struct error *err);

/* reference_samples32()'s masks, and the share of lit ones. The results are the callee's, valid until the next call. */
const float *exact_shadows_samples32(struct exact_shadows *e, const struct view *view, struct job_pool *pool,
                                     const uint32_t **receivers, const uint32_t **lit, struct error *err);

struct exact_figures {
    double tests_per_receiver; /* triangles tried a sample that may receive light (a pixel's samples are tried together) */
    double undecided_fraction; /* of samples tried, those that single precision left to double */
    double exact;              /* decisions in integers */
    double grid_side, grid_entries;
};

/* Of the last picture. Tests and undecided samples depend a little on what threads learned from each other and from earlier pictures. */
struct exact_figures exact_shadows_figures(const struct exact_shadows *e);
size_t exact_shadows_bytes(const struct exact_shadows *e);

/* Which instruction set the next pictures use, for tests: 0 the best there is, 1 the plain one. */
void exact_shadows_use_plain(struct exact_shadows *e, bool plain);
