/* Which triangles may show in which tile of the picture. */
#pragma once

#include "exact/triangles.h"
#include "scene/view.h"

struct job_pool;

enum { TILE_SIDE = 16 };

struct bins {
    uint32_t columns, rows; /* tiles */
    float (*corners)[3]; /* of every vertex: its picture position, NAN: not in front of the near plane; and bin_entry.nearest */
    struct bin_range *ranges;  /* of every triangle */
    uint32_t *first;           /* entries of each tile, one more than tiles */
    struct bin_entry *entries; /* by id within chunks */
    uint32_t most;             /* entries of a tile */
    size_t vertex_room, triangle_room, tile_room, entry_room;
    uint32_t *counts;
};

/* Tiles a triangle's box meets; left > right: none. */
struct bin_range {
    uint16_t left, right, top, bottom;
    float nearest;
};

/* nearest: not less than 1 / t of any of its points in perspective, -t else: visible.h's keys. INFINITY: not known. */
struct bin_entry {
    uint32_t id;
    float nearest;
};

/* Picture positions in `corners` are off by less than this, relative to 1 + their size. */
#define BIN_MARGIN 0x1p-12f

/* False when memory is out. `b` keeps its memory between frames. */
bool bins_fill(struct bins *b, const struct triangles *t, const struct view *view, struct job_pool *pool);
void bins_finish(struct bins *b);
size_t bins_bytes(const struct bins *b);
