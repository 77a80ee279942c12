#include "shadow/geometry/geometry_points.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "shadow/geometry/geometry_kernel.h"

enum { TILE_POINTS_MAX = 4096 }; /* a job's: a picture may lie in one tile */

static bool out_of_memory(struct error *err)
{
    return error_set(err, ERROR_TRY_AGAIN, "size", "out of memory for the points of a picture");
}

static bool reserve(void **array, size_t *room, size_t count, size_t element)
{
    if (*room >= count)
        return true;
    /* A camera that moves needs a little more each time. */
    count += count / 4;
    void *more = count <= SIZE_MAX / element ? realloc(*array, count * element) : NULL;
    if (!more)
        return false;
    *array = more;
    *room = count;
    return true;
}

bool point_list_reserve(struct point_list *l, size_t more)
{
    return reserve((void **)&l->points, &l->room, l->count + more, sizeof *l->points);
}

/* Counts become starts, tile after tile. */
static bool place_points(struct point_job *job)
{
    struct geometry_points *g = job->points;
    size_t total = 0, pieces = 0;
    g->tile_count = 0;
    for (unsigned map = 0; map < job->receivers->map_count; map++)
        for (size_t tile = job->first_tile[map]; tile < job->first_tile[map + 1]; tile++) {
            size_t first = total;
            for (size_t chunk = 0; chunk < POINT_CHUNKS; chunk++) {
                uint32_t *start = &g->starts[tile * POINT_CHUNKS + chunk], count = *start;
                *start = (uint32_t)total;
                total += count;
            }
            pieces += (total - first + TILE_POINTS_MAX - 1) / TILE_POINTS_MAX;
            if (!reserve((void **)&g->tiles, &g->tile_room, pieces, sizeof *g->tiles))
                return false;
            for (; first < total; first += TILE_POINTS_MAX)
                g->tiles[g->tile_count++] =
                    (struct tile_points){map, first, total - first < TILE_POINTS_MAX ? total - first : TILE_POINTS_MAX};
        }
    g->sorted.count = 0;
    return point_list_reserve(&g->sorted, total);
}

static void sort_points(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    struct point_job *job = context;
    const struct point_list *found = &job->points->found[chunk];
    for (size_t k = 0; k < found->count; k++) {
        const struct map_point *p = &found->points[k];
        job->points->sorted.points[job->points->starts[(size_t)point_tile(job, p) * POINT_CHUNKS + chunk]++] = *p;
    }
}

bool geometry_points_find(struct geometry_points *g, const struct depth_job *receivers, const uint32_t *ids,
                          const struct geometry_map *maps, struct job_pool *pool, struct error *err)
{
    struct point_job job = {receivers, ids, maps, g, {0}, {0}};
    size_t tiles = 0;
    for (unsigned map = 0; map < receivers->map_count; map++) {
        tiles += maps[map].slot_count;
        job.first_tile[map + 1] = (uint32_t)tiles;
    }
    if (!reserve((void **)&g->starts, &g->start_room, tiles * POINT_CHUNKS, sizeof *g->starts))
        return out_of_memory(err);
    if (tiles > 0)
        memset(g->starts, 0, tiles * POINT_CHUNKS * sizeof *g->starts);
    job_pool_for(pool, POINT_CHUNKS, geometry_kernel_choose()->find_points, &job);
    for (size_t chunk = 0; chunk < POINT_CHUNKS; chunk++)
        if (job.failed[chunk])
            return out_of_memory(err);
    if (!place_points(&job))
        return out_of_memory(err);
    job_pool_for(pool, POINT_CHUNKS, sort_points, &job);
    return true;
}

void geometry_points_finish(struct geometry_points *g)
{
    for (size_t chunk = 0; chunk < POINT_CHUNKS; chunk++)
        free(g->found[chunk].points);
    free(g->sorted.points);
    free(g->tiles);
    free(g->starts);
    memset(g, 0, sizeof *g);
}

size_t geometry_points_bytes(const struct geometry_points *g)
{
    size_t points = g->sorted.room;
    for (size_t chunk = 0; chunk < POINT_CHUNKS; chunk++)
        points += g->found[chunk].room;
    return points * sizeof *g->sorted.points + g->tile_room * sizeof *g->tiles + g->start_room * sizeof *g->starts;
}
