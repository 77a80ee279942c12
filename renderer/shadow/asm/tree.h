/* Which pages there are and what they refine. A slot is a place for a page in the pool's textures; the root of each map takes a block of slots, a
 * page refines one cell of the page above it. Every page but the roots' can be freed once nothing refines it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gl/buffer.h"
#include "scene/view.h"

struct error;
struct gl_context;

#define ASM_ROOT UINT32_MAX       /* as a parent: none */
#define ASM_FREE (UINT32_MAX - 1) /* as a parent: no page is here */

struct asm_node {
    uint32_t parent;   /* slot */
    uint32_t x, y;     /* of its first texel in its map, texels of its level */
    uint32_t used;     /* the last frame in which a pixel found it */
    uint32_t worth;    /* pixels that would ask for it, were it not there */
    uint16_t children; /* a bit a cell */
    uint8_t level;     /* 0: root */
    uint8_t map;
};

struct asm_tree {
    uint32_t slots;
    unsigned map_count;
    uint32_t root_side; /* texels */
    struct view maps[6];
    struct asm_node *nodes; /* a slot each */
    uint32_t *free;         /* free slots, the next to be taken last */
    uint32_t free_count;
    /* Child of each cell of each slot, 0: none. */
    struct gl_buffer table; /* UNIT_ASM_TABLE; for shaders */
    uint32_t *cells;        /* for the CPU, instead */
};

/* Makes room; every slot is free. gl: NULL for a tree that the CPU looks up. */
bool asm_tree_init(struct asm_tree *t, struct gl_context *gl, uint32_t slots, struct error *err);
void asm_tree_finish(struct asm_tree *t);
/* Bytes a slot takes, and that all take now. */
size_t asm_tree_slot_bytes(void);
size_t asm_tree_bytes(const struct asm_tree *t);

/* Largest power of two, at most 512, for the side of the roots of `maps` maps that leaves two thirds of the slots to pages below. */
uint32_t asm_tree_root_side(uint32_t slots, unsigned maps);

/* Plants roots that see `maps`; to be called on an empty tree. */
void asm_tree_plant(struct asm_tree *t, const struct view *maps, unsigned map_count);

/* Column and row of the first slot of a root. */
void asm_tree_root_place(const struct asm_tree *t, unsigned map, uint32_t *column, uint32_t *row);

/* A page for cell `cell` of `parent`; ASM_FREE when no slot is free. The GPU hears of it at once: fill it before the next pass. */
uint32_t asm_tree_add(struct asm_tree *t, uint32_t parent, unsigned cell);
/* Frees a page that has no children and is no root. */
void asm_tree_remove(struct asm_tree *t, uint32_t slot);
/* Frees every page that is no root. */
void asm_tree_prune(struct asm_tree *t);

/* What page `slot` sees. */
struct view asm_tree_view(const struct asm_tree *t, uint32_t slot);
/* Frees every page, roots excepted, that sees part of the map's rectangle [x0, x1] x [y0, y1] (of 1): what a mesh that moves invalidates is where
 * its bounds were and are. Returns how many. The roots are the caller's to fill again. */
uint32_t asm_tree_invalidate(struct asm_tree *t, unsigned map, const double rectangle[4]);

static inline bool asm_node_is_page(const struct asm_node *n) { return n->parent < ASM_FREE; }
