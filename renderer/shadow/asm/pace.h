/* How many pages a frame's time allows. Fernando et al. 2001: a page costs a * texels + b; a and b are measured when a tree is made. Every page has
 * the same number of texels, so cost decides how many are made and never which. */
#pragma once

#include <stdbool.h>

#include "shadow/asm/pages.h"

struct asm_pace {
    double texel_us, page_us; /* a and b as measured */
    double cost_us;           /* of a page, as used */
};

/* Measures on `pages`, whose free slots it overwrites; the roots are filled. */
bool asm_pace_measure(struct asm_pace *pace, struct asm_pages *pages, const struct asm_tree *tree, const struct shadow_input *in,
                      struct error *err);

/* Pages in `ms`, at least 8. */
unsigned asm_pace_pages(const struct asm_pace *pace, double ms);
