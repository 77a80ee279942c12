#include "shadow/asm/look_up.h"

#include "base/job_pool.h"
#include "passes/gbuffer.h"
#include "shadow/asm/pages.h"
#include "shadow/asm/place.h"

static const struct asm_kernel *choose_kernel(void)
{
#ifdef __x86_64__
    if (asm_avx2.resolve && __builtin_cpu_supports("avx2"))
        return &asm_avx2;
#endif
    return &asm_plain;
}

bool asm_job_init(struct asm_job *job, const struct asm_tree *tree, const struct asm_pages *pages, const struct shadow_input *in,
                  struct error *err)
{
    const struct view *v = in->view;
    *job = (struct asm_job){.ids = gbuffer_read_ids(in->gbuffer, in->gl, err),
                            .cells = tree->cells,
                            .depths = pages->kept_depths,
                            .page_ids = pages->kept_ids,
                            .grain = (float)((v->top - v->bottom) / v->height),
                            .parallel = v->orthographic};
    asm_place_block(tree, v, &job->block);
    if (!job->ids || !depth_job_begin(&job->depth, in, err))
        return false;
    job->depth.map_count = tree->map_count;
    job->depth.orthographic = tree->maps[0].orthographic;
    return true;
}

void asm_job_run(struct asm_job *job, struct job_pool *pool, bool analyse)
{
    const struct asm_kernel *kernel = choose_kernel();
    job_pool_for(pool, depth_job_count(&job->depth), kernel->resolve, job);
    if (analyse)
        job_pool_for(pool, depth_job_count(&job->depth), kernel->analyse, job);
}
