/* What the camera needs of the trees, counted by shaders/asm_analysis.comp or on the CPU (look_up.h); what a frame counts is read in the next one,
 * so nobody waits. Counters go on from frame to frame until they are cleared. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gl/buffer.h"
#include "shadow/asm/tree.h"

struct shadow_input;

struct asm_analysis {
    struct gl_buffer counters; /* for shaders */
    void *fence;               /* GLsync; NULL: nothing is under way */
    uint32_t *kept;            /* for the CPU instead: the counters; owned */
    size_t kept_bytes;
    bool counted; /* on the CPU, since they were mapped last */
    uint32_t slots;
    uint32_t turn; /* which of each `every` pixels is next */
};

struct asm_counters {
    uint32_t *cells;  /* pixels that want a page, for each cell of each slot */
    uint32_t *worth;  /* pixels that would ask for this slot's page, were it not there */
    uint32_t *used;   /* 1: some pixel found its leaf here */
    uint32_t *levels; /* pixels at a shadow's boundary that found a leaf of this level; ASM_LEVELS + 1 */
};

/* gl: NULL for counters on the CPU. */
bool asm_analysis_init(struct asm_analysis *a, struct gl_context *gl, uint32_t slots, struct error *err);
void asm_analysis_finish(struct asm_analysis *a);
size_t asm_analysis_slot_bytes(void);
size_t asm_analysis_bytes(const struct asm_analysis *a);

/* Starts counting on the GPU, if nothing is under way. The light's and the trees' blocks, the picture's pixels and ids are bound
 * (shadow_run_full_screen() did). */
bool asm_analysis_start(struct asm_analysis *a, const struct shadow_input *in, const char *defines, unsigned every,
                        struct error *err);
/* Counters on the CPU, for the caller to count this turn's pixels before it maps them. */
struct asm_counters asm_analysis_count(struct asm_analysis *a, unsigned every);
/* The counters for reading and writing, until asm_analysis_unmap(); false when nothing was under way or it is not done yet. */
bool asm_analysis_map(struct asm_analysis *a, struct asm_counters *out);
void asm_analysis_unmap(struct asm_analysis *a);
void asm_analysis_clear(struct asm_analysis *a);
