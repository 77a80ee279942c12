/* The last word: one sample, one triangle, by docs/truth.md with the reference's predicates (reference/exact.h, reference/rules.h). Some
 * microseconds each; called where the bounds of exact/lines.h do not decide, and for masks. Thread-safe. */
#pragma once

#include "exact/triangles.h"
#include "reference/exact.h"
#include "scene/view.h"

struct slow {
    const struct triangles *triangles;
    const struct view *view;
    const struct light *light;
    struct exact_apex to_light;
    uint64_t exact; /* decided in integers */
};

struct sample_ray {
    struct dvec3 origin, direction;
};

static inline struct sample_ray sample_ray(const struct view *view, double x, double y)
{
    struct sample_ray r;
    view_ray(view, x, y, &r.origin, &r.direction);
    return r;
}

/* True when the ray's line crosses the inside of `id`. */
bool slow_crosses(struct slow *s, const struct sample_ray *ray, uint32_t id);

/* Everything else that "meets" asks: slope, near and far, hidden faces, the mask. */
bool slow_meets(struct slow *s, const struct sample_ray *ray, uint32_t id);

/* True when the ray, which crosses the inside of `id`, finds it solid there. */
bool slow_sees_solid(const struct slow *s, const struct sample_ray *ray, uint32_t id);

/* True when the ray meets `first` before `second` (both are met): nearer, or as near with the lower id. */
bool slow_is_before(struct slow *s, const struct sample_ray *ray, uint32_t first, uint32_t second);

/* True when the point of `receiver` is one for the light: docs/truth.md, "Receivers". */
bool slow_receives(struct slow *s, const struct sample_ray *ray, uint32_t receiver);

/* The light's side of the triangle: sign of N . (L - a). */
int slow_light_side(struct slow *s, uint32_t id);

/* True when `occluder` shadows the point of `receiver`. light_side: slow_light_side(occluder), not 0. */
bool slow_blocks(struct slow *s, const struct sample_ray *ray, uint32_t receiver, uint32_t occluder, int light_side);

/* True when the line to the light, which crosses the inside of `occluder`, finds it solid there. */
bool slow_is_solid(const struct slow *s, const struct sample_ray *ray, uint32_t receiver, uint32_t occluder);
