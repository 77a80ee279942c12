#include "shadow/asm/analysis.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "blocks.h"
#include "gl/context.h"
#include "gl/program.h"
#include "shadow/shadow.h"

#define CELLS  (ASM_CELLS * ASM_CELLS)
#define GROUP  8 /* local size of asm_analysis.comp */
#define LEVELS 16

size_t asm_analysis_slot_bytes(void) { return (CELLS + 2) * sizeof(uint32_t); }

size_t asm_analysis_bytes(const struct asm_analysis *a) { return a->counters.size + a->kept_bytes; }

bool asm_analysis_init(struct asm_analysis *a, struct gl_context *gl, uint32_t slots, struct error *err)
{
    memset(a, 0, sizeof *a);
    a->slots = slots;
    size_t size = slots * asm_analysis_slot_bytes() + LEVELS * sizeof(uint32_t);
    if (!gl) {
        a->kept = calloc(1, size);
        a->kept_bytes = a->kept ? size : 0;
        return a->kept || error_set(err, ERROR_TRY_AGAIN, "budget", "out of memory for a shadow tree's counters");
    }
    glCreateBuffers(1, &a->counters.id);
    a->counters.size = size;
    glNamedBufferStorage(a->counters.id, (GLsizeiptr)a->counters.size, NULL, GL_MAP_READ_BIT | GL_MAP_WRITE_BIT);
    asm_analysis_clear(a);
    return gl_check(gl, err);
}

static void drop_fence(struct asm_analysis *a)
{
    if (a->fence)
        glDeleteSync(a->fence);
    a->fence = NULL;
}

void asm_analysis_finish(struct asm_analysis *a)
{
    drop_fence(a);
    gl_buffer_finish(&a->counters);
    free(a->kept);
    memset(a, 0, sizeof *a);
}

bool asm_analysis_start(struct asm_analysis *a, const struct shadow_input *in, const char *defines, unsigned every,
                        struct error *err)
{
    if (a->fence)
        return true;
    char all[256];
    snprintf(all, sizeof all, "LIGHT %d\n%s", (int)in->light->kind, defines);
    struct gl_program *program = gl_programs_get(in->gl->programs, "asm_analysis.comp", NULL, all, err);
    if (!program)
        return false;
    gl_program_use(program);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, a->counters.id);
    uint32_t columns = (in->view->width + every - 1) / every;
    glDispatchCompute((columns + GROUP - 1) / GROUP, (in->view->height + GROUP - 1) / GROUP, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    a->fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    a->turn = (a->turn + 1) % every;
    return gl_check(in->gl, err);
}

static uint32_t *map_gpu(struct asm_analysis *a)
{
    if (!a->fence)
        return NULL;
    GLenum done = glClientWaitSync(a->fence, GL_SYNC_FLUSH_COMMANDS_BIT, 0);
    if (done != GL_ALREADY_SIGNALED && done != GL_CONDITION_SATISFIED)
        return NULL;
    drop_fence(a);
    return glMapNamedBufferRange(a->counters.id, 0, (GLsizeiptr)a->counters.size, GL_MAP_READ_BIT | GL_MAP_WRITE_BIT);
}

static struct asm_counters counters_at(uint32_t *all, size_t slots)
{
    return (struct asm_counters){all, all + slots * CELLS, all + slots * (CELLS + 1), all + slots * (CELLS + 2)};
}

struct asm_counters asm_analysis_count(struct asm_analysis *a, unsigned every)
{
    a->counted = true;
    a->turn = (a->turn + 1) % every;
    return counters_at(a->kept, a->slots);
}

bool asm_analysis_map(struct asm_analysis *a, struct asm_counters *out)
{
    uint32_t *all = a->kept ? (a->counted ? a->kept : NULL) : map_gpu(a);
    a->counted = false;
    if (all)
        *out = counters_at(all, a->slots);
    return all;
}

void asm_analysis_unmap(struct asm_analysis *a)
{
    if (!a->kept)
        glUnmapNamedBuffer(a->counters.id);
}

void asm_analysis_clear(struct asm_analysis *a)
{
    static const uint32_t none;
    if (a->kept)
        memset(a->kept, 0, a->kept_bytes);
    else
        glClearNamedBufferData(a->counters.id, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &none);
}
