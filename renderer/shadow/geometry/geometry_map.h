/* The conservative geometry shadow map (papers/coverage-li-2017, 2.2 and 2.3): of every texel the nearest depth that anything in it can have, and
 * one triangle: the front-most over the texel's centre; where none covers the centre, the one nearest to it.
 *
 * Kept in tiles of 32 x 32 texels, only where casters are: 8 bytes a texel, and 4 for what a system keeps beside (lists). Built on the job
 * pool: triangles are projected, sorted into tiles, and each tile is rasterized by one job, so the result depends on no order. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shadow/geometry/light_mesh.h"

#define MAP_TILE     32u
#define MAP_NONE     UINT32_MAX
#define MAP_ID       0x7fffffffu /* of map_cell.triangle */
#define MAP_OFF_EDGE 0x80000000u /* its triangle does not cover the texel's centre */

struct map_cell {
    float nearest;     /* no point of the texel with a nearness of at least this is shadowed; -INFINITY: nothing there */
    uint32_t triangle; /* drawn id, MAP_OFF_EDGE; MAP_NONE: none */
};

struct geometry_map {
    struct light_mesh mesh;
    uint32_t size, tiles;   /* texels, tiles a side */
    uint32_t *slot;         /* of each tile, MAP_NONE: nothing in it */
    struct map_cell *cells; /* MAP_TILE^2 a slot */
    uint32_t *notes;        /* likewise; 0 after each build: the system's own */
    size_t slot_count, slot_room;
    uint32_t *wild; /* triangles that go the slow way */
    size_t wild_count, wild_room;
    uint32_t *entries; /* triangles of tile after tile */
    size_t entry_room;
    uint32_t *counts; /* entries of each (chunk, tile, side), then where they start */
    size_t count_room;
    uint32_t *homes; /* of each triangle: where it goes, where that is one place */
    size_t home_room;
};

/* Builds it anew. ERROR_TRY_AGAIN when memory is out. */
bool geometry_map_build(struct geometry_map *m, const struct scene *scene, const struct view *view, const uint32_t *casters,
                        size_t caster_count, struct job_pool *pool, struct error *err);
void geometry_map_finish(struct geometry_map *m);
size_t geometry_map_bytes(const struct geometry_map *m);

/* Index of texel (x, y), both in [0, size), into cells and notes; SIZE_MAX where nothing is. */
static inline size_t geometry_map_at(const struct geometry_map *m, uint32_t x, uint32_t y)
{
    uint32_t slot = m->slot[(size_t)(y / MAP_TILE) * m->tiles + x / MAP_TILE];
    return slot == MAP_NONE ? SIZE_MAX : (size_t)slot * MAP_TILE * MAP_TILE + (y % MAP_TILE) * MAP_TILE + x % MAP_TILE;
}

/* The triangle of any texel, off the map too; MAP_NONE where there is none. */
static inline uint32_t geometry_map_triangle(const struct geometry_map *m, int32_t x, int32_t y)
{
    if ((uint32_t)x >= m->size || (uint32_t)y >= m->size)
        return MAP_NONE;
    size_t at = geometry_map_at(m, (uint32_t)x, (uint32_t)y);
    return at == SIZE_MAX ? MAP_NONE : m->cells[at].triangle;
}
