#include "shadow/geometry/geometry_maps.h"

#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "passes/gbuffer.h"
#include "shadow/pixel_pass.h"

bool geometry_maps_prepare(struct geometry_maps *g, const struct shadow_input *in, struct error *err)
{
    for (unsigned i = in->fit->map_count; i < g->count; i++)
        geometry_map_finish(&g->maps[i]);
    g->count = 0;
    for (unsigned i = 0; i < in->fit->map_count; i++) {
        if (!geometry_map_build(&g->maps[i], in->scene, &in->fit->maps[i], in->fit->casters, in->fit->caster_count, in->pool,
                                err))
            return false;
        g->count = i + 1;
        if (in->memory && geometry_maps_bytes(g) > in->memory)
            return error_set(err, ERROR_TRY_AGAIN, "memory", "geometry maps of %u x %u take more than the %zu MiB allowed",
                             in->fit->maps[i].width, in->fit->maps[i].width, in->memory >> 20);
    }
    return true;
}

void geometry_maps_finish(struct geometry_maps *g)
{
    for (unsigned i = 0; i < SHADOW_MAPS_MAX; i++)
        geometry_map_finish(&g->maps[i]);
    geometry_points_finish(&g->points);
    memset(g, 0, sizeof *g);
}

size_t geometry_maps_bytes(const struct geometry_maps *g)
{
    size_t sum = geometry_points_bytes(&g->points);
    for (unsigned i = 0; i < SHADOW_MAPS_MAX; i++)
        sum += geometry_map_bytes(&g->maps[i]);
    return sum;
}

struct decide_job {
    const struct geometry_maps *maps;
    geometry_decide *decide;
    void *state;
    const double *params;
    float *visibility;
};

static void decide_tile(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct decide_job *job = context;
    const struct tile_points *t = &job->maps->points.tiles[index];
    job->decide(job->state, &job->maps->maps[t->map], job->maps->points.sorted.points + t->first, t->count, job->params,
                job->visibility);
}

bool geometry_maps_resolve(struct geometry_maps *g, const struct shadow_input *in, geometry_decide *decide, void *state,
                           struct error *err)
{
    struct depth_job receivers;
    const uint32_t *ids = gbuffer_read_ids(in->gbuffer, in->gl, err);
    if (!ids || !depth_job_begin(&receivers, in, err))
        return false;
    receivers.map_count = g->count;
    for (unsigned i = 0; i < g->count; i++)
        receivers.maps[i] = depth_map_of(&g->maps[i].mesh.view, in->view->eye);
    receivers.orthographic = g->count > 0 && g->maps[0].mesh.view.orthographic;
    receivers.side = g->count > 0 ? (int32_t)g->maps[0].size : 0;
    if (!geometry_points_find(&g->points, &receivers, ids, g->maps, in->pool, err))
        return false;
    struct decide_job job = {g, decide, state, in->params, receivers.visibility};
    job_pool_for(in->pool, g->points.tile_count, decide_tile, &job);
    return pixel_upload(in, receivers.visibility, err);
}
