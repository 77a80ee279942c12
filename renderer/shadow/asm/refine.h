/* Which pages are made and which give way. Best first: a cell's benefit is the number of pixels that ask for it, and every page costs the same.
 * When the budget is spent, pages that no pixel of this view has used give way, least recently used first; then, at the end of a round
 * of the analysis, when every pixel has had its turn, a page that fewer pixels need than ask for the new one. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/asm/analysis.h"
#include "shadow/asm/tree.h"

#define ASM_REQUESTS 8192

struct asm_request {
    uint32_t count, key; /* pixels; slot * 16 + cell, or slot */
};

struct asm_refine {
    struct asm_request *requests, *victims; /* ASM_REQUESTS each */
    uint32_t *made;                         /* slots to be filled; ASM_REQUESTS */
    size_t made_count;
    uint32_t refinements, evictions; /* of the last frame */
};

bool asm_refine_init(struct asm_refine *r, struct error *err);
void asm_refine_finish(struct asm_refine *r);
size_t asm_refine_bytes(void);

/* Notes which pages were used in `frame` and what they are worth. */
void asm_refine_note(struct asm_tree *tree, const struct asm_counters *counters, uint32_t frame);

/* Makes at most `most` pages: r->made lists them, for the caller to fill. `seen_since`: pages not used from this frame on may give way;
 * whole_round: counts are of all pixels. */
void asm_refine_run(struct asm_refine *r, struct asm_tree *tree, const struct asm_counters *counters, unsigned most,
                    uint32_t seen_since, bool whole_round);

/* After the light moved: keeps the `most` pages of least level and then most worth, with all they stand on, and lists them in r->made to be filled
 * anew; frees the others. */
void asm_refine_keep(struct asm_refine *r, struct asm_tree *tree, unsigned most);
