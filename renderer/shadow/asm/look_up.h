/* Look-ups in the trees on the CPU, eight pixels at a time: what shaders/asm.frag and shaders/asm_analysis.comp do where the GL device is a CPU as
 * well (shadow/depth/depth_pass.h says why). The arithmetic is the shaders', but for roundings; the loops are compiled once an instruction set
 * (look_up_plain.c, look_up_avx2.c), to the same bits. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "blocks.h"
#include "shadow/asm/analysis.h"
#include "shadow/depth/depth_pass.h"

struct asm_pages;
struct job_pool;

/* One light of one picture at work. */
struct asm_job {
    struct depth_job depth; /* pixels, light, bias, the maps' kind; it knows no texel */
    const uint32_t *ids;    /* the picture's triangles */
    struct asm_block block;
    const uint32_t *cells; /* struct asm_tree */
    const float *depths;   /* struct asm_pages */
    const uint32_t *page_ids;
    /* For the analysis only. */
    struct asm_counters counters;
    float detail, grain; /* parameter; a pixel's size, at depth 1 if the camera is perspective */
    bool parallel;       /* the camera */
};

struct asm_kernel {
    depth_rows *resolve, *analyse; /* of struct asm_job, as many as depth_job_count(); the second after all of the first */
};
extern const struct asm_kernel asm_plain, asm_avx2; /* the latter empty where the compiler has none */

/* For a tree and pages that are for the CPU. All but detail and counters, and of block what asm_place_block() leaves. */
bool asm_job_init(struct asm_job *job, const struct asm_tree *tree, const struct asm_pages *pages, const struct shadow_input *in,
                  struct error *err);
/* Fills job->depth.visibility; then, if asked, counts this turn's pixels. */
void asm_job_run(struct asm_job *job, struct job_pool *pool, bool analyse);
