/* The figures of `render --stats` and `compare --json`. Names are a promise: they stay. */
#pragma once

#include <jansson.h>

#include "renderer.h"

struct against;
struct comparison;
struct flicker_figures;
struct identified;
struct measurement;
struct metrics;
struct stage;

/* One measured picture. The caller owns the object; NULL when memory is out. */
json_t *figures_render(const struct scene *scene, const struct render_settings *settings, const struct device_info *device,
                       const struct measurement *measured);

/* A row of a sequence: {frame_ms, shadow_bytes, prepared, converged, figures}. */
json_t *figures_frame(const struct frame_info *frame);

/* The error figures of one light, or pooled over all. What was not measured is null. */
json_t *figures_errors(const struct metrics *metrics);

/* What a system tells of itself: {name: value}; NULL where it tells nothing. */
json_t *figures_told(const struct shadow_figure *figures, size_t count);

/* The members identified_*, null where no lists were `given`. */
void figures_add_identified(json_t *object, bool given, const struct identified *m);

/* Adds what only a comparison has to figures_render()'s object. */
void figures_add_comparison(json_t *figures, const struct against *against, const struct stage *stage,
                            const struct comparison *c);

/* `flicker`: one a motion (flicker_run.h). Adds nothing when none was measured. */
void figures_add_flicker(json_t *figures, const struct flicker_figures *flicker);

/* Values of a system's parameters: {"size": 1024, "layout": "exact", ...}; a choice that is a number is written as one. */
json_t *figures_params(const struct shadow_system *system, const struct shadow_params *params);
