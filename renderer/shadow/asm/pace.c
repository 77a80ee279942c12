#include "shadow/asm/pace.h"

#include <epoxy/gl.h>
#include <math.h>

#include "blocks.h"
#include "gl/context.h"
#include "gl/timer.h"
#include "shadow/shadow.h"

/* A page on the machine this was written on, two cores and no GPU. What is measured is rounded to this times a power of four: a stop-watch never
 * says the same twice, and the same command on the same device is to give the same pictures, frame by frame. */
#define USUAL_US 16.0
#define RUNS     3
#define PAGES    32
#define LEAST    8

/* Of the root, cut into pages: they are where they were, so nothing changes. */
static unsigned root_slots(const struct asm_tree *tree, uint32_t slots[PAGES])
{
    unsigned count = 0;
    for (uint32_t i = 0; i < tree->slots && count < PAGES; i++)
        if (tree->nodes[i].parent == ASM_ROOT)
            slots[count++] = i;
    return count;
}

/* Least of some runs, ms; INFINITY on failure. */
static double time_pages(struct asm_pages *pages, const struct asm_tree *tree, const uint32_t *slots, unsigned count,
                         const struct shadow_input *in, struct error *err)
{
    double least = INFINITY;
    for (int i = 0; i < RUNS; i++) {
        glFinish();
        double start = clock_ms();
        if (!asm_pages_fill(pages, tree, slots, count, in, err))
            return INFINITY;
        glFinish();
        least = fmin(least, clock_ms() - start);
    }
    return least;
}

static double time_roots(struct asm_pages *pages, const struct asm_tree *tree, const struct shadow_input *in, struct error *err)
{
    glFinish();
    double start = clock_ms();
    if (!asm_pages_fill_roots(pages, tree, in, err))
        return INFINITY;
    glFinish();
    return clock_ms() - start;
}

bool asm_pace_measure(struct asm_pace *pace, struct asm_pages *pages, const struct asm_tree *tree, const struct shadow_input *in,
                      struct error *err)
{
    uint32_t slots[PAGES];
    unsigned count = root_slots(tree, slots);
    double large_texels = (double)tree->root_side * tree->root_side * tree->map_count, small_texels = ASM_PAGE * ASM_PAGE;
    double large = time_roots(pages, tree, in, err) * 1e3;
    double small = count ? time_pages(pages, tree, slots, count, in, err) * 1e3 / count : 0;
    if (isinf(large) || isinf(small))
        return false;
    pace->texel_us = fmax(0, (large - small) / fmax(large_texels - small_texels, 1));
    pace->page_us = fmax(0, small - pace->texel_us * small_texels);
    double cost = pace->texel_us * small_texels + pace->page_us;
    pace->cost_us = USUAL_US * exp2(2 * round(log2(fmax(cost, 1e-3) / USUAL_US) / 2));
    return true;
}

unsigned asm_pace_pages(const struct asm_pace *pace, double ms)
{
    double pages = ms * 1e3 / pace->cost_us;
    return pages < LEAST ? LEAST : pages > 1e6 ? 1000000 : (unsigned)pages;
}
