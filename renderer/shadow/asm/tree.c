#include "shadow/asm/tree.h"

#include <assert.h>
#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "blocks.h"

#define CELLS     (ASM_CELLS * ASM_CELLS)
#define ROOT_SIDE 512u /* Fernando et al. 2001 */

size_t asm_tree_slot_bytes(void) { return sizeof(struct asm_node) + sizeof(uint32_t) + CELLS * sizeof(uint32_t); }

size_t asm_tree_bytes(const struct asm_tree *t)
{
    return t->slots * (sizeof(struct asm_node) + sizeof(uint32_t)) + t->table.size +
           (t->cells ? t->slots * CELLS * sizeof *t->cells : 0);
}

/* The last slots are taken first, so that the roots, which are planted at the front, find their places free. */
static void free_all(struct asm_tree *t)
{
    t->free_count = 0;
    for (uint32_t i = 0; i < t->slots; i++)
        if (t->nodes[i].parent != ASM_ROOT) {
            t->nodes[i].parent = ASM_FREE;
            t->free[t->free_count++] = i;
        }
}

bool asm_tree_init(struct asm_tree *t, struct gl_context *gl, uint32_t slots, struct error *err)
{
    memset(t, 0, sizeof *t);
    t->nodes = calloc(slots, sizeof *t->nodes);
    t->free = calloc(slots, sizeof *t->free);
    if (!gl)
        t->cells = calloc((size_t)slots * CELLS, sizeof *t->cells);
    if (!t->nodes || !t->free || (!gl && !t->cells)) {
        asm_tree_finish(t);
        return error_set(err, ERROR_TRY_AGAIN, "budget", "out of memory for a tree of %u pages", slots);
    }
    t->slots = slots;
    free_all(t);
    return !gl || gl_buffer_set(&t->table, gl, NULL, (size_t)slots * CELLS * sizeof(uint32_t), GL_R32UI, err);
}

void asm_tree_finish(struct asm_tree *t)
{
    free(t->nodes);
    free(t->free);
    free(t->cells);
    gl_buffer_finish(&t->table);
    memset(t, 0, sizeof *t);
}

uint32_t asm_tree_root_side(uint32_t slots, unsigned maps)
{
    uint32_t side = ROOT_SIDE;
    for (; side > ASM_PAGE; side /= 2) {
        uint32_t pages = side / ASM_PAGE, abreast = ASM_COLUMNS / pages, rows = (maps + abreast - 1) / abreast * pages;
        if (maps * pages * pages <= slots / 3 && rows <= slots / ASM_COLUMNS)
            break;
    }
    return side;
}

void asm_tree_root_place(const struct asm_tree *t, unsigned map, uint32_t *column, uint32_t *row)
{
    uint32_t pages = t->root_side / ASM_PAGE, abreast = ASM_COLUMNS / pages;
    *column = map % abreast * pages;
    *row = map / abreast * pages;
}

static void clear_cells(struct asm_tree *t)
{
    static const uint32_t none;
    if (t->cells)
        memset(t->cells, 0, t->slots * CELLS * sizeof *t->cells);
    else
        glClearNamedBufferData(t->table.id, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &none);
}

void asm_tree_plant(struct asm_tree *t, const struct view *maps, unsigned map_count)
{
    t->map_count = map_count;
    t->root_side = asm_tree_root_side(t->slots, map_count);
    memcpy(t->maps, maps, map_count * sizeof *maps);
    for (uint32_t i = 0; i < t->slots; i++)
        t->nodes[i].parent = ASM_FREE;
    for (unsigned m = 0; m < map_count; m++) {
        uint32_t pages = t->root_side / ASM_PAGE, column, row;
        asm_tree_root_place(t, m, &column, &row);
        for (uint32_t i = 0; i < pages * pages; i++) {
            uint32_t x = i % pages, y = i / pages;
            t->nodes[(row + y) * ASM_COLUMNS + column + x] =
                (struct asm_node){.parent = ASM_ROOT, .x = x * ASM_PAGE, .y = y * ASM_PAGE, .map = (uint8_t)m};
        }
    }
    free_all(t);
    clear_cells(t);
}

static void set_child(struct asm_tree *t, uint32_t slot, unsigned cell, uint32_t child)
{
    size_t at = (size_t)slot * CELLS + cell;
    if (t->cells)
        t->cells[at] = child;
    else
        glNamedBufferSubData(t->table.id, (GLintptr)(at * sizeof child), sizeof child, &child);
}

uint32_t asm_tree_add(struct asm_tree *t, uint32_t parent, unsigned cell)
{
    struct asm_node *above = &t->nodes[parent];
    assert(above->parent != ASM_FREE && !(above->children & 1u << cell) && above->level < ASM_LEVELS);
    if (t->free_count == 0)
        return ASM_FREE;
    uint32_t slot = t->free[--t->free_count];
    above->children |= (uint16_t)(1u << cell);
    t->nodes[slot] = (struct asm_node){.parent = parent,
                                       .x = above->x * ASM_CELLS + cell % ASM_CELLS * ASM_PAGE,
                                       .y = above->y * ASM_CELLS + cell / ASM_CELLS * ASM_PAGE,
                                       .level = (uint8_t)(above->level + 1),
                                       .map = above->map};
    set_child(t, parent, cell, slot);
    return slot;
}

void asm_tree_remove(struct asm_tree *t, uint32_t slot)
{
    struct asm_node *n = &t->nodes[slot], *above = &t->nodes[n->parent];
    assert(asm_node_is_page(n) && n->children == 0);
    unsigned cell = n->x / ASM_PAGE % ASM_CELLS + n->y / ASM_PAGE % ASM_CELLS * ASM_CELLS;
    above->children &= (uint16_t) ~(1u << cell);
    set_child(t, n->parent, cell, 0);
    n->parent = ASM_FREE;
    t->free[t->free_count++] = slot;
}

void asm_tree_prune(struct asm_tree *t)
{
    for (uint32_t i = 0; i < t->slots; i++)
        t->nodes[i].children = 0;
    free_all(t);
    clear_cells(t);
}

struct view asm_tree_view(const struct asm_tree *t, uint32_t slot)
{
    const struct asm_node *n = &t->nodes[slot];
    struct view v = t->maps[n->map];
    double side = ldexp(t->root_side, 2 * n->level);
    double width = v.right_edge - v.left, height = v.bottom - v.top, left = v.left, top = v.top;
    v.left = left + width * (n->x / side);
    v.right_edge = left + width * ((n->x + ASM_PAGE) / side);
    v.top = top + height * (n->y / side);
    v.bottom = top + height * ((n->y + ASM_PAGE) / side);
    v.width = v.height = ASM_PAGE;
    return v;
}

static bool touches(const struct asm_tree *t, const struct asm_node *n, const double r[4])
{
    double side = ldexp(t->root_side, 2 * n->level);
    return n->x < r[2] * side && n->x + ASM_PAGE > r[0] * side && n->y < r[3] * side && n->y + ASM_PAGE > r[1] * side;
}

/* It or a page that it refines. */
static bool line_touches(const struct asm_tree *t, const struct asm_node *n, const double r[4])
{
    for (; asm_node_is_page(n); n = &t->nodes[n->parent])
        if (touches(t, n, r))
            return true;
    return false;
}

uint32_t asm_tree_invalidate(struct asm_tree *t, unsigned map, const double rectangle[4])
{
    uint32_t removed = 0;
    for (unsigned level = ASM_LEVELS; level > 0; level--)
        for (uint32_t i = 0; i < t->slots; i++) {
            const struct asm_node *n = &t->nodes[i];
            if (!asm_node_is_page(n) || n->level != level || n->map != map || !line_touches(t, n, rectangle))
                continue;
            asm_tree_remove(t, i);
            removed++;
        }
    return removed;
}
