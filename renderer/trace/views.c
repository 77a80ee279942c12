/* Many small light maps at once: a job each, where tracer_light() would start and end a loop for every one of them. */
#include <math.h>

#include "base/job_pool.h"
#include "trace/rays.h"

struct views_job {
    const struct tracer *tracer;
    RTCScene tree;
    const struct view *views;
    size_t stride;
    float *depths;
    uint32_t *ids;
};

static void write_packet(const struct views_job *job, size_t index, const struct ray_frame *frame, const int valid[LANES],
                         const struct RTCRayHit16 *packet, uint32_t x, uint32_t y)
{
    uint32_t ids[LANES];
    hit_ids(job->tracer, &packet->hit, ids);
    for (uint32_t i = 0; i < LANES; i++) {
        if (!valid[i])
            continue;
        size_t at = index * job->stride + (size_t)(y + i / PACKET) * job->views[index].width + x + i % PACKET;
        job->depths[at] = ids[i] == SCENE_NONE ? INFINITY : (float)frame->start + packet->ray.tfar[i];
        job->ids[at] = ids[i];
    }
}

static void trace_view(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct views_job *job = context;
    const struct view *view = &job->views[index];
    const struct ray_frame frame = ray_frame_make(view);
    const struct ray_offsets offsets = ray_offsets_pixels(&frame);
    const struct tile whole = {0, 0, view->width, view->height};
    struct RTCRayHit16 packet;
    int valid[LANES] __attribute__((aligned(64)));
    struct RTCIntersectContext query;
    rtcInitIntersectContext(&query);
    query.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    ray_frame_start(&frame, &packet);
    for (uint32_t y = 0; y < view->height; y += PACKET)
        for (uint32_t x = 0; x < view->width; x += PACKET) {
            ray_frame_packet(&frame, &offsets, x, y, &packet);
            tile_lanes(&whole, x, y, valid);
            rtcIntersect16(valid, job->tree, &query, &packet);
            write_packet(job, index, &frame, valid, &packet, x, y);
        }
}

void tracer_light_views(const struct tracer *t, const struct view *views, size_t count, size_t stride, const uint32_t *casters,
                        size_t caster_count, struct job_pool *pool, float *depths, uint32_t *ids)
{
    struct views_job job = {t, tree_of_casters(t, casters, caster_count), views, stride, depths, ids};
    if (!job.tree)
        job.tree = t->all;
    job_pool_for(pool, count, trace_view, &job);
}
