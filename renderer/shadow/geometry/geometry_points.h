/* The receivers that a light's geometry maps do not tell to be lit by their texels' nearest depths, sorted by the maps' tiles: what a tile
 * keeps is then read while it is near, and what its points share is worked out once. */
#pragma once

#include "shadow/depth/depth_pass.h"
#include "shadow/geometry/geometry_map.h"

enum { POINT_CHUNKS = 16 }; /* parts that points are found and sorted in, whatever the threads */

/* A receiver on a map. */
struct map_point {
    float x, y, n;  /* as in light_mesh.h */
    uint32_t id;    /* its triangle, drawn id */
    uint32_t at;    /* its texel, in cells and notes */
    uint32_t map;   /* which of the light's */
    uint32_t pixel; /* in the picture */
};

struct point_list {
    struct map_point *points;
    size_t count, room;
};

/* Points of one tile; where there are very many, some of them. */
struct tile_points {
    unsigned map;
    size_t first, count;
};

/* Kept from frame to frame for its memory. */
struct geometry_points {
    struct point_list found[POINT_CHUNKS], sorted;
    struct tile_points *tiles;
    size_t tile_count, tile_room;
    uint32_t *starts; /* of each (tile, chunk) in sorted */
    size_t start_room;
};

/* Sets the visibility of all other receivers to 1 and of what is no receiver to 0; of those found too it is 1. `visibility` is receivers->visibility;
 * receivers->maps are placed. ERROR_TRY_AGAIN when memory is out. */
bool geometry_points_find(struct geometry_points *g, const struct depth_job *receivers, const uint32_t *ids,
                          const struct geometry_map *maps, struct job_pool *pool, struct error *err);
void geometry_points_finish(struct geometry_points *g);
size_t geometry_points_bytes(const struct geometry_points *g);

/* At work. */
struct point_job {
    const struct depth_job *receivers;
    const uint32_t *ids;
    const struct geometry_map *maps;
    struct geometry_points *points;
    uint32_t first_tile[SHADOW_MAPS_MAX + 1]; /* of each map, of all their slots together */
    bool failed[POINT_CHUNKS];
};

/* Room for `more` points. */
bool point_list_reserve(struct point_list *l, size_t more);

static inline uint32_t point_tile(const struct point_job *job, const struct map_point *p)
{
    return job->first_tile[p->map] + p->at / (MAP_TILE * MAP_TILE);
}
