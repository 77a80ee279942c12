#include "shadow/asm/refine.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "blocks.h"

#define CELLS (ASM_CELLS * ASM_CELLS)

size_t asm_refine_bytes(void) { return ASM_REQUESTS * (2 * sizeof(struct asm_request) + sizeof(uint32_t)); }

bool asm_refine_init(struct asm_refine *r, struct error *err)
{
    memset(r, 0, sizeof *r);
    r->requests = malloc(ASM_REQUESTS * sizeof *r->requests);
    r->victims = malloc(ASM_REQUESTS * sizeof *r->victims);
    r->made = malloc(ASM_REQUESTS * sizeof *r->made);
    return (r->requests && r->victims && r->made) || error_set(err, ERROR_TRY_AGAIN, "budget", "out of memory for a shadow tree");
}

void asm_refine_finish(struct asm_refine *r)
{
    free(r->requests);
    free(r->victims);
    free(r->made);
    memset(r, 0, sizeof *r);
}

void asm_refine_note(struct asm_tree *tree, const struct asm_counters *counters, uint32_t frame)
{
    for (uint32_t i = 0; i < tree->slots; i++) {
        tree->nodes[i].worth = counters->worth[i];
        if (counters->used[i])
            tree->nodes[i].used = frame;
        counters->used[i] = 0;
    }
}

/* Most pixels first; a total order, so that the same requests give the same pages. */
static int by_benefit(const void *a, const void *b)
{
    const struct asm_request *x = a, *y = b;
    if (x->count != y->count)
        return x->count < y->count ? 1 : -1;
    return x->key < y->key ? -1 : x->key > y->key;
}

static int by_least(const void *a, const void *b)
{
    const struct asm_request *x = a, *y = b;
    if (x->count != y->count)
        return x->count < y->count ? -1 : 1;
    return x->key < y->key ? -1 : x->key > y->key;
}

/* Coarse pages come first in the scan of a tree that grows: when there are more requests than room for them, those of a few pixels each are left for
 * later. */
static size_t find_requests(struct asm_refine *r, const struct asm_tree *tree, const struct asm_counters *counters)
{
    size_t count = 0;
    for (uint32_t least = 8;; least = 1) {
        count = 0;
        for (uint32_t i = 0; i < tree->slots && count < ASM_REQUESTS; i++) {
            const struct asm_node *n = &tree->nodes[i];
            if (n->parent == ASM_FREE || n->level >= ASM_LEVELS)
                continue;
            for (uint32_t c = 0; c < CELLS && count < ASM_REQUESTS; c++)
                if (counters->cells[i * CELLS + c] >= least && !(n->children & 1u << c))
                    r->requests[count++] = (struct asm_request){counters->cells[i * CELLS + c], i * CELLS + c};
        }
        if (least == 1 || count >= ASM_REQUESTS / 2)
            break;
    }
    qsort(r->requests, count, sizeof *r->requests, by_benefit);
    return count;
}

/* Pages that may give way, first choice first. by_worth: all of them, by worth; else those unused since a frame, by when they were used. */
static size_t find_victims(struct asm_refine *r, const struct asm_tree *tree, bool by_worth, uint32_t seen_since)
{
    size_t count = 0;
    for (uint32_t i = 0; i < tree->slots && count < ASM_REQUESTS; i++) {
        const struct asm_node *n = &tree->nodes[i];
        if (asm_node_is_page(n) && n->children == 0 && (by_worth || n->used < seen_since))
            r->victims[count++] = (struct asm_request){by_worth ? n->worth : n->used, i};
    }
    qsort(r->victims, count, sizeof *r->victims, by_least);
    return count;
}

static void forget(const struct asm_counters *counters, uint32_t slot)
{
    memset(counters->cells + (size_t)slot * CELLS, 0, CELLS * sizeof *counters->cells);
    counters->worth[slot] = 0;
}

static void make(struct asm_refine *r, struct asm_tree *tree, const struct asm_counters *counters, const struct asm_request *q,
                 uint32_t frame)
{
    uint32_t slot = asm_tree_add(tree, q->key / CELLS, q->key % CELLS);
    forget(counters, slot);
    counters->cells[q->key] = 0;
    counters->worth[slot] = q->count;
    tree->nodes[slot].worth = q->count;
    tree->nodes[slot].used = frame;
    r->made[r->made_count++] = slot;
    r->refinements++;
}

/* Victims of a kind, taken one by one. */
struct queue {
    bool filled, by_worth;
    size_t count, next;
};

/* A page that may make place for a request by so many pixels: false when there is none. A margin keeps two pages from taking each other's place for
 * ever. A page that the request stands on has worth beyond the request's own, or has it as a child by then. */
static bool evict(struct asm_refine *r, struct asm_tree *tree, struct queue *q, uint32_t seen_since,
                  const struct asm_request *for_whom)
{
    if (!q->filled)
        q->count = find_victims(r, tree, q->by_worth, seen_since);
    q->filled = true;
    for (; q->next < q->count; q->next++) {
        const struct asm_request *v = &r->victims[q->next];
        const struct asm_node *n = &tree->nodes[v->key];
        if (n->children || v->key == for_whom->key / CELLS)
            continue;
        if (q->by_worth && v->count + v->count / 4 + 1 >= for_whom->count)
            return false;
        asm_tree_remove(tree, v->key);
        q->next++;
        r->evictions++;
        return true;
    }
    return false;
}

void asm_refine_run(struct asm_refine *r, struct asm_tree *tree, const struct asm_counters *counters, unsigned most,
                    uint32_t seen_since, bool whole_round)
{
    struct queue unused = {0}, poor = {.by_worth = true};
    bool spent = false; /* victims by use and by worth share their room */
    size_t count = find_requests(r, tree, counters);
    for (size_t i = 0; i < count && r->made_count < most && r->made_count < ASM_REQUESTS; i++) {
        const struct asm_request *q = &r->requests[i];
        /* The page that asks may have given way since; its slot may even be another page's, whose counts start from nothing. */
        if (tree->nodes[q->key / CELLS].parent == ASM_FREE || counters->cells[q->key] != q->count)
            continue;
        if (tree->free_count == 0 && !spent)
            spent = !evict(r, tree, &unused, seen_since, q);
        if (tree->free_count == 0 && !(whole_round && evict(r, tree, &poor, seen_since, q)))
            break;
        make(r, tree, counters, q, seen_since);
    }
}

static int by_level(const struct asm_tree *tree, uint32_t a, uint32_t b)
{
    const struct asm_node *x = &tree->nodes[a], *y = &tree->nodes[b];
    if (x->level != y->level)
        return x->level < y->level ? -1 : 1;
    if (x->worth != y->worth)
        return x->worth < y->worth ? 1 : -1;
    return a < b ? -1 : a > b;
}

static int compare_slots(const void *a, const void *b, void *tree)
{
    return by_level(tree, *(const uint32_t *)a, *(const uint32_t *)b);
}

/* A page that others stand on is worth what they are, too. */
static void sum_worth(struct asm_tree *tree)
{
    for (unsigned level = ASM_LEVELS; level > 1; level--)
        for (uint32_t i = 0; i < tree->slots; i++)
            if (asm_node_is_page(&tree->nodes[i]) && tree->nodes[i].level == level)
                tree->nodes[tree->nodes[i].parent].worth += tree->nodes[i].worth;
}

/* Deepest first, so that nothing is freed that something stands on. */
static void remove_unmarked(struct asm_tree *tree)
{
    for (unsigned level = ASM_LEVELS; level > 0; level--)
        for (uint32_t i = 0; i < tree->slots; i++)
            if (asm_node_is_page(&tree->nodes[i]) && tree->nodes[i].level == level && tree->nodes[i].used == 0)
                asm_tree_remove(tree, i);
}

void asm_refine_keep(struct asm_refine *r, struct asm_tree *tree, unsigned most)
{
    size_t count = 0, kept = 0;
    sum_worth(tree);
    for (uint32_t i = 0; i < tree->slots && count < ASM_REQUESTS; i++)
        if (asm_node_is_page(&tree->nodes[i]))
            r->made[count++] = i;
    qsort_r(r->made, count, sizeof *r->made, compare_slots, tree);
    for (uint32_t i = 0; i < tree->slots; i++)
        if (asm_node_is_page(&tree->nodes[i]))
            tree->nodes[i].used = 0;
    for (size_t i = 0; i < count && kept < most; i++) {
        struct asm_node *n = &tree->nodes[r->made[i]], *above = &tree->nodes[n->parent];
        if (n->worth == 0 || (asm_node_is_page(above) && above->used == 0))
            continue;
        n->used = 1;
        r->made[kept++] = r->made[i];
    }
    remove_unmarked(tree);
    r->made_count = kept;
}
