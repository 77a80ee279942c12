#include "shadow/geometry_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "shadow/map_tile.h"

enum { CHUNKS = 16 }; /* parts that triangles are sorted in, whatever the threads: each has a count per tile */

struct build {
    struct geometry_map *map;
    size_t starts[CHUNKS + 1]; /* of each chunk, in the order of the mesh's triangles */
    bool filling;              /* second sweep: put entries where the first one's counts say */
    uint32_t *wild;            /* of each chunk, of the first sweep: how many */
};

static bool out_of_memory(struct error *err)
{
    return error_set(err, ERROR_TRY_AGAIN, "size", "out of memory for a geometry map");
}

static bool reserve(void **array, size_t *room, size_t count, size_t element, struct error *err)
{
    if (*room >= count)
        return true;
    free(*array);
    *room = 0;
    *array = count <= SIZE_MAX / element ? malloc(count * element) : NULL;
    if (!*array)
        return out_of_memory(err);
    *room = count;
    return true;
}

/* The box of a triangle in tiles; false where it lies off the map. */
struct tile_range {
    uint32_t x0, y0, x1, y1; /* inclusive */
};

static bool tiles_of(const struct geometry_map *m, const struct light_triangle *t, struct tile_range *out)
{
    const struct light_vertex *a = t->corner[0], *b = t->corner[1], *c = t->corner[2];
    const float side = (float)m->size, reach = CONSERVATIVE_MARGIN;
    float left = fminf(fminf(a->x, b->x), c->x) - reach, right = fmaxf(fmaxf(a->x, b->x), c->x) + reach;
    float top = fminf(fminf(a->y, b->y), c->y) - reach, bottom = fmaxf(fmaxf(a->y, b->y), c->y) + reach;
    if (!(left < side && right >= 0 && top < side && bottom >= 0))
        return false;
    uint32_t last = m->tiles - 1;
    out->x0 = left > 0 ? (uint32_t)left / MAP_TILE : 0;
    out->y0 = top > 0 ? (uint32_t)top / MAP_TILE : 0;
    out->x1 = right < side ? (uint32_t)right / MAP_TILE : last;
    out->y1 = bottom < side ? (uint32_t)bottom / MAP_TILE : last;
    return true;
}

/* Whether the triangle touches a tile: as for a texel, in units of tiles. */
static bool touches_tile(const struct light_triangle *t, uint32_t x, uint32_t y)
{
    float px[3], py[3];
    for (int k = 0; k < 3; k++) {
        px[k] = t->corner[k]->x / MAP_TILE - (float)x;
        py[k] = t->corner[k]->y / MAP_TILE - (float)y;
    }
    return conservative_touches(px, py, 0, 0);
}

static void sort_triangle(const struct build *b, const struct light_part *part, uint32_t id, uint32_t *counts, uint32_t *wild)
{
    struct geometry_map *m = b->map;
    struct light_triangle t = light_part_triangle(part, id);
    struct tile_range range;
    if (light_triangle_wild(&t)) {
        if (light_part_degenerate(m->mesh.scene, part, id))
            return;
        if (b->filling)
            m->wild[*wild] = id;
        ++*wild;
        return;
    }
    if (!tiles_of(m, &t, &range))
        return;
    bool many = range.x1 > range.x0 && range.y1 > range.y0;
    for (uint32_t y = range.y0; y <= range.y1; y++)
        for (uint32_t x = range.x0; x <= range.x1; x++) {
            if (many && !touches_tile(&t, x, y))
                continue;
            uint32_t *count = &counts[(size_t)y * m->tiles + x];
            if (b->filling)
                m->entries[*count] = id;
            ++*count;
        }
}

static void sort_chunk(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct build *b = context;
    struct geometry_map *m = b->map;
    uint32_t *counts = m->counts + chunk * m->tiles * m->tiles, *wild = &b->wild[chunk];
    if (!b->filling)
        memset(counts, 0, (size_t)m->tiles * m->tiles * sizeof *counts);
    size_t at = 0; /* of the part's first triangle */
    for (size_t p = 0; p < m->mesh.part_count && at < b->starts[chunk + 1]; p++) {
        const struct light_part *part = &m->mesh.parts[p];
        size_t first = at < b->starts[chunk] ? b->starts[chunk] - at : 0;
        size_t end = b->starts[chunk + 1] - at < part->triangle_count ? b->starts[chunk + 1] - at : part->triangle_count;
        for (size_t i = first; i < end; i++)
            sort_triangle(b, part, part->first_triangle + (uint32_t)i, counts, wild);
        at += part->triangle_count;
    }
}

/* Counts become starts: a tile's entries lie together, chunk after chunk. Hands out slots to tiles that hold any. */
static bool place_entries(struct build *b, struct error *err)
{
    struct geometry_map *m = b->map;
    size_t tiles = (size_t)m->tiles * m->tiles, total = 0, slots = 0;
    uint32_t wild = 0;
    for (size_t chunk = 0; chunk < CHUNKS; chunk++) {
        uint32_t count = b->wild[chunk];
        b->wild[chunk] = wild;
        wild += count;
    }
    m->wild_count = wild;
    for (size_t tile = 0; tile < tiles; tile++) {
        size_t before = total;
        for (size_t chunk = 0; chunk < CHUNKS; chunk++) {
            uint32_t *count = &m->counts[chunk * tiles + tile], n = *count;
            *count = (uint32_t)total;
            total += n;
        }
        m->slot[tile] = total > before || wild > 0 ? (uint32_t)slots++ : MAP_NONE;
    }
    if (total >= MAP_NONE)
        return error_set(err, ERROR_TRY_AGAIN, "size", "too many triangles for a map of %u x %u", m->size, m->size);
    m->slot_count = slots;
    size_t texels = slots * MAP_TILE * MAP_TILE;
    if (m->slot_room < slots) {
        free(m->notes);
        m->notes = calloc(texels, sizeof *m->notes);
        if (!reserve((void **)&m->cells, &m->slot_room, slots, MAP_TILE * MAP_TILE * sizeof *m->cells, err) || !m->notes) {
            m->slot_room = 0;
            return m->notes ? false : out_of_memory(err);
        }
    } else {
        memset(m->notes, 0, texels * sizeof *m->notes);
    }
    return reserve((void **)&m->entries, &m->entry_room, total, sizeof *m->entries, err) &&
           reserve((void **)&m->wild, &m->wild_room, wild, sizeof *m->wild, err);
}

static void fill_tile(void *context, size_t tile, unsigned worker)
{
    (void)worker;
    const struct build *b = context;
    struct geometry_map *m = b->map;
    if (m->slot[tile] == MAP_NONE)
        return;
    /* After the second sweep a chunk's start is where the next one's entries begin; the first one's is the end of the tile before. */
    size_t tiles = (size_t)m->tiles * m->tiles;
    uint32_t first = tile == 0 ? 0 : m->counts[(CHUNKS - 1) * tiles + tile - 1], end = m->counts[(CHUNKS - 1) * tiles + tile];
    map_tile_rasterize(m, (uint32_t)(tile % m->tiles), (uint32_t)(tile / m->tiles), m->entries + first, end - first,
                       m->cells + (size_t)m->slot[tile] * MAP_TILE * MAP_TILE);
}

static bool build_tiles(struct geometry_map *m, struct job_pool *pool, struct error *err)
{
    uint32_t wild[CHUNKS] = {0};
    struct build b = {.map = m, .wild = wild};
    for (size_t k = 0; k <= CHUNKS; k++)
        b.starts[k] = m->mesh.triangle_count * k / CHUNKS;
    job_pool_for(pool, CHUNKS, sort_chunk, &b);
    if (!place_entries(&b, err))
        return false;
    b.filling = true;
    job_pool_for(pool, CHUNKS, sort_chunk, &b);
    job_pool_for(pool, (size_t)m->tiles * m->tiles, fill_tile, &b);
    return true;
}

static bool resize(struct geometry_map *m, uint32_t size, struct error *err)
{
    uint32_t tiles = (size + MAP_TILE - 1) / MAP_TILE;
    if (m->size == size)
        return true;
    m->size = 0;
    free(m->slot);
    m->slot = malloc((size_t)tiles * tiles * sizeof *m->slot);
    m->tiles = tiles;
    if (!m->slot || !reserve((void **)&m->counts, &m->count_room, (size_t)tiles * tiles * CHUNKS, sizeof *m->counts, err))
        return m->slot ? false : out_of_memory(err);
    m->size = size;
    return true;
}

bool geometry_map_build(struct geometry_map *m, const struct scene *scene, const struct view *view, const uint32_t *casters,
                        size_t caster_count, struct job_pool *pool, struct error *err)
{
    if (scene->drawn_triangle_count >= MAP_ID)
        return error_set(err, ERROR_TRY_AGAIN, "scene", "%zu triangles are more than a geometry map can name (%u)",
                         scene->drawn_triangle_count, MAP_ID - 1);
    return resize(m, view->width, err) && light_mesh_project(&m->mesh, scene, view, casters, caster_count, pool, err) &&
           build_tiles(m, pool, err);
}

void geometry_map_finish(struct geometry_map *m)
{
    light_mesh_finish(&m->mesh);
    free(m->slot);
    free(m->cells);
    free(m->notes);
    free(m->wild);
    free(m->entries);
    free(m->counts);
    memset(m, 0, sizeof *m);
}

size_t geometry_map_bytes(const struct geometry_map *m)
{
    return light_mesh_bytes(&m->mesh) + (size_t)m->tiles * m->tiles * sizeof *m->slot +
           m->slot_room * MAP_TILE * MAP_TILE * (sizeof *m->cells + sizeof *m->notes) + m->wild_room * sizeof *m->wild +
           m->entry_room * sizeof *m->entries + m->count_room * sizeof *m->counts;
}
