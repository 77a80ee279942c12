/* The second opinion: docs/truth.md in rational arithmetic, over every triangle for every ray. */
#pragma once

#include "scene/scene.h"
#include "scene/view.h"

struct rational;

/* For one thread at a time. `scene` must outlive it. */
struct rational *rational_create(const struct scene *scene);
void rational_destroy(struct rational *r);

/* The triangle that picture position (x, y) sees; SCENE_NONE: none. */
uint32_t rational_visible(struct rational *r, const struct view *view, double x, double y);

enum rational_answer { RATIONAL_NO_RECEIVER, RATIONAL_SHADOWED, RATIONAL_LIT };

/* What reaches the point at which the ray through (x, y) meets the plane of drawn triangle `id` (SCENE_NONE: no receiver). */
enum rational_answer rational_light(struct rational *r, const struct view *view, const struct light *light, uint32_t id, double x,
                                    double y);
