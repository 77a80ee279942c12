/* The camera pass and light maps, traced. */
#include <math.h>

#include "base/job_pool.h"
#include "trace/rays.h"
#include "trace/surface.h"

struct camera_job {
    const struct tracer *tracer;
    const struct view *view;
    struct ray_frame frame;
    struct ray_offsets offsets;
    uint32_t *ids;
    struct pixel *pixels;
};

static void write_pixels(const struct camera_job *job, const int valid[LANES], const struct RTCRayHit16 *packet,
                         const float facing[LANES], uint32_t x, uint32_t y)
{
    struct pixel pixels[LANES];
    surface_pixels(job->tracer->surfaces, packet, facing, (float)job->frame.start, pixels);
    for (uint32_t i = 0; i < LANES; i++)
        if (valid[i])
            job->pixels[(size_t)(y + i / PACKET) * job->view->width + x + i % PACKET] = pixels[i];
}

static void write_ids(const struct camera_job *job, const int valid[LANES], const struct RTCHit16 *hit, uint32_t x, uint32_t y)
{
    uint32_t ids[LANES];
    hit_ids(job->tracer, hit, ids);
    for (uint32_t i = 0; i < LANES; i++)
        if (valid[i])
            job->ids[(size_t)(y + i / PACKET) * job->view->width + x + i % PACKET] = ids[i];
}

static void camera_tile(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct camera_job *job = context;
    const struct tile tile = tile_at(job->view, index);
    struct RTCRayHit16 packet;
    int valid[LANES] __attribute__((aligned(64)));
    float facing[LANES];
    ray_frame_start(&job->frame, &packet);
    for (uint32_t y = tile.y; y < tile.y + tile.height; y += PACKET)
        for (uint32_t x = tile.x; x < tile.x + tile.width; x += PACKET) {
            ray_frame_packet(&job->frame, &job->offsets, x, y, &packet);
            tile_lanes(&tile, x, y, valid);
            trace_visible(job->tracer, valid, job->frame.tfar, &packet, facing);
            write_ids(job, valid, &packet.hit, x, y);
            if (job->pixels)
                write_pixels(job, valid, &packet, facing, x, y);
        }
}

void tracer_camera(const struct tracer *t, const struct view *view, struct job_pool *pool, uint32_t *ids, struct pixel *pixels)
{
    struct camera_job job = {.tracer = t, .view = view, .frame = ray_frame_make(view), .ids = ids, .pixels = pixels};
    job.offsets = ray_offsets_pixels(&job.frame);
    job_pool_for(pool, tile_count(view), camera_tile, &job);
}

struct light_job {
    const struct tracer *tracer;
    RTCScene tree;
    const struct view *view;
    struct ray_frame frame;
    struct ray_offsets offsets;
    float *depths;
    uint32_t *ids;
};

static void write_depths(const struct light_job *job, const int valid[LANES], const struct RTCRayHit16 *packet, uint32_t x,
                         uint32_t y)
{
    uint32_t ids[LANES];
    hit_ids(job->tracer, &packet->hit, ids);
    for (uint32_t i = 0; i < LANES; i++) {
        if (!valid[i])
            continue;
        size_t at = (size_t)(y + i / PACKET) * job->view->width + x + i % PACKET;
        if (job->depths)
            job->depths[at] = ids[i] == SCENE_NONE ? INFINITY : (float)job->frame.start + packet->ray.tfar[i];
        if (job->ids)
            job->ids[at] = ids[i];
    }
}

static void light_tile(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct light_job *job = context;
    const struct tile tile = tile_at(job->view, index);
    struct RTCRayHit16 packet;
    int valid[LANES] __attribute__((aligned(64)));
    struct RTCIntersectContext query;
    rtcInitIntersectContext(&query);
    query.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    ray_frame_start(&job->frame, &packet);
    for (uint32_t y = tile.y; y < tile.y + tile.height; y += PACKET)
        for (uint32_t x = tile.x; x < tile.x + tile.width; x += PACKET) {
            ray_frame_packet(&job->frame, &job->offsets, x, y, &packet);
            tile_lanes(&tile, x, y, valid);
            rtcIntersect16(valid, job->tree, &query, &packet);
            write_depths(job, valid, &packet, x, y);
        }
}

void tracer_light(const struct tracer *t, const struct view *view, const uint32_t *casters, size_t caster_count,
                  struct job_pool *pool, float *depths, uint32_t *ids)
{
    struct light_job job = {.tracer = t, .view = view, .frame = ray_frame_make(view), .depths = depths, .ids = ids};
    job.offsets = ray_offsets_pixels(&job.frame);
    job.tree = tree_of_casters(t, casters, caster_count);
    if (!job.tree)
        job.tree = t->all;
    job_pool_for(pool, tile_count(view), light_tile, &job);
}

void tracer_light_ids(const struct tracer *t, const struct view *views, size_t count, const uint32_t *casters,
                      size_t caster_count, float *depths, uint32_t *ids)
{
    RTCScene tree = tree_of_casters(t, casters, caster_count);
    for (size_t i = 0; i < count; i++) {
        struct light_job job = {.tracer = t,
                                .tree = tree ? tree : t->all,
                                .view = &views[i],
                                .frame = ray_frame_make(&views[i]),
                                .depths = depths,
                                .ids = ids};
        job.offsets = ray_offsets_pixels(&job.frame);
        for (size_t tile = 0; tile < tile_count(&views[i]); tile++)
            light_tile(&job, tile, 0);
        ids += (size_t)views[i].width * views[i].height;
        depths = depths ? depths + (size_t)views[i].width * views[i].height : NULL;
    }
}
