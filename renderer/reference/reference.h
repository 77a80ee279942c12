/* Ray-traced truth. What it is, word for word, is in docs/truth.md; in short:
 *
 * A sample's receiver is the nearest visible triangle on its ray (view_ray), equal depth: the lower id; at the exact intersection of
 * the ray with the triangle's plane. It is a receiver for a light if its geometric normal turned towards the eye has N.L > 0 (exact
 * sign) and it lies within the light's cone and range. It is shadowed iff the open segment to the light crosses the interior of another
 * triangle: exact signs; edges half-open by a tie rule on the canonical edge direction; a coplanar triangle does not cross; zero-area
 * and non-finite triangles are ignored; a triangle with holes is crossed only where material_alpha >= cutoff.
 *
 * All vertices, rays and lights are doubles taken as exact. Candidates come from an Embree tree over boxes widened past every rounding;
 * each is decided in double with a certified error bound, and by exact rational arithmetic (GMP) where that cannot tell. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"
#include "scene/view.h"

struct error;
struct job_pool;
struct reference;

/* `scene` must outlive it. */
struct reference *reference_create(const struct scene *scene, unsigned threads, struct error *err);
void reference_destroy(struct reference *r);
size_t reference_bytes(const struct reference *r);

struct reference_counts {
    uint64_t rays;  /* primary and shadow */
    uint64_t tests; /* ray against triangle */
    uint64_t exact; /* of those, decided by rational arithmetic */
};

/* Called now and then from any worker with done in [0, 1]; return false to stop early. */
struct reference_progress {
    bool (*report)(void *context, double done);
    void *context;
};

/* *point*: the triangle at each pixel is the one in `ids` (as the camera pass wrote it), its point the exact intersection of the
 * pixel-centre ray with its plane. visibility: 1 lit, 0 shadowed or no receiver. receiver: 1 where there is one, may be NULL.
 * counts may be NULL. False when stopped early. */
bool reference_point(const struct reference *r, const struct view *view, const struct light *light, const uint32_t *ids,
                     struct job_pool *pool, const struct reference_progress *progress, float *visibility, uint8_t *receiver,
                     struct reference_counts *counts);

/* *samples32*: per pixel a mask of the samples that have a receiver facing the light, and of those, the lit ones.
 * V = popcount(lit) / popcount(receivers), 0 if there is none. one_triangle: 1 where all 32 samples see the same triangle, else 0; may
 * be NULL. */
bool reference_samples32(const struct reference *r, const struct view *view, const struct light *light, struct job_pool *pool,
                         const struct reference_progress *progress, uint32_t *receivers, uint32_t *lit, uint8_t *one_triangle,
                         struct reference_counts *counts);
