/* The scene as one view sees it: positions relative to the view's eye, computed in double; and rasterizing it from there. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gl/buffer.h"
#include "scene/view.h"

struct draw_scene;
struct error;

struct draw_view {
    struct view view;
    struct gl_buffer rows;     /* UNIT_ROWS */
    struct gl_buffer commands; /* indirect draws */
    struct gl_buffer block;    /* draw_block */
};

/* Makes `v` look from `view`. */
bool draw_view_set(struct draw_view *v, const struct draw_scene *scene, const struct view *view, struct error *err);
/* The same where only the picture's edges and size differ from what was set. */
bool draw_view_set_edges(struct draw_view *v, const struct draw_scene *scene, const struct view *view, struct error *err);
void draw_view_finish(struct draw_view *v);

enum draw_what {
    DRAW_IDS,       /* the camera's: ids and depth; hides back faces of single-sided materials */
    DRAW_DEPTH_IDS, /* as DRAW_DEPTH, and ids */
    DRAW_DEPTH,     /* a light's: depth alone; every triangle, whichever side it shows; nothing is cut off by the near plane */
};

/* Rasterizes `instances` (ascending; NULL: all) into the bound framebuffer, culling those outside the view. Depth is reversed: near / depth
 * in perspective, (far - depth) / (far - near) in orthographic; the caller cleared it to 0. */
bool draw_view_rasterize(struct draw_view *v, struct draw_scene *scene, enum draw_what what, const uint32_t *instances,
                         size_t instance_count, struct error *err);
