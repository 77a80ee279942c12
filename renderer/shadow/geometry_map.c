#include "shadow/geometry_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "shadow/conservative.h"
#include "shadow/map_tile.h"

enum { CHUNKS = 16 }; /* parts that triangles are sorted in, whatever the threads: each has a count per tile */

/* A tile has two bins: triangles that turn clockwise and those that turn the other way. Where a mesh is closed, one of them is hidden by the
 * other, which is rasterized first. */
enum { BINS = 2 };
#define HOME_NONE UINT32_MAX       /* touches no tile */
#define HOME_MANY (UINT32_MAX - 1) /* several tiles, or wild */

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
    /* A light that moves needs a little more each time: fresh pages cost more than the room. */
    count += count / 4;
    free(*array);
    *room = 0;
    *array = count <= SIZE_MAX / element ? malloc(count * element) : NULL;
    if (!*array)
        return out_of_memory(err);
    *room = count;
    return true;
}

/* The triangle over the map's tiles, as if those were texels; false where it lies off the map. */
static bool over_tiles(const struct geometry_map *m, const struct light_triangle *t, struct conservative *out)
{
    const float scale = 1.0f / MAP_TILE; /* exact, and so margins only grow: a texel's, of a tile */
    float x[3], y[3];
    for (int k = 0; k < 3; k++) {
        x[k] = t->corner[k]->x * scale;
        y[k] = t->corner[k]->y * scale;
    }
    return conservative_setup(out, x, y, (int32_t)m->tiles, (int32_t)m->tiles);
}

/* Mirrored coordinates, y down: what faces the light in a mesh of counter-clockwise faces turns clockwise in space and has a positive area. */
static uint32_t bin_of(const struct geometry_map *m, float area, uint32_t x, uint32_t y)
{
    return (y * m->tiles + x) * BINS + (area < 0 ? 0 : 1);
}

/* Of a triangle within one tile, the bin; else HOME_MANY. Most are, and need no edges. */
static uint32_t only_bin(const struct geometry_map *m, const struct light_triangle *t)
{
    float x[3], y[3];
    for (int k = 0; k < 3; k++) {
        x[k] = t->corner[k]->x;
        y[k] = t->corner[k]->y;
    }
    const float reach = CONSERVATIVE_MARGIN, side = (float)m->size;
    float left = CONSERVATIVE_LEAST(x) - reach, right = CONSERVATIVE_MOST(x) + reach;
    float top = CONSERVATIVE_LEAST(y) - reach, bottom = CONSERVATIVE_MOST(y) + reach;
    if (!(left >= 0 && top >= 0 && right < side && bottom < side))
        return HOME_MANY;
    uint32_t column = (uint32_t)left / MAP_TILE, row = (uint32_t)top / MAP_TILE;
    if (column != (uint32_t)right / MAP_TILE || row != (uint32_t)bottom / MAP_TILE)
        return HOME_MANY;
    return bin_of(m, (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]), column, row);
}

static void put_entry(const struct build *b, uint32_t *counts, uint32_t bin, uint32_t id)
{
    if (b->filling)
        b->map->entries[counts[bin]] = id;
    counts[bin]++;
}

static void put_wild(const struct build *b, const struct light_part *part, uint32_t id, uint32_t *wild)
{
    struct geometry_map *m = b->map;
    struct dvec3 c[3];
    for (unsigned k = 0; k < 3; k++)
        c[k] = light_part_corner(&m->mesh, part, id, k);
    if (light_corners_miss(&m->mesh, c, 0, 0, m->size, m->size) || light_part_degenerate(m->mesh.scene, part, id))
        return;
    if (b->filling)
        m->wild[*wild] = id;
    ++*wild;
}

/* Returns its home. */
static uint32_t sort_triangle(const struct build *b, const struct light_part *part, uint32_t id, uint32_t *counts, uint32_t *wild)
{
    struct geometry_map *m = b->map;
    struct light_triangle t = light_part_triangle(part, id);
    struct conservative over;
    if (light_triangle_wild(&t)) {
        put_wild(b, part, id, wild);
        return HOME_MANY;
    }
    uint32_t bin = only_bin(m, &t);
    if (bin != HOME_MANY) {
        put_entry(b, counts, bin, id);
        return bin;
    }
    if (!over_tiles(m, &t, &over))
        return HOME_NONE;
    for (int32_t y = over.y0; y <= over.y1; y++)
        for (int32_t x = over.x0; x <= over.x1; x += CONSERVATIVE_LANES)
            for (unsigned bits = conservative_row(&over, x, y); bits; bits &= bits - 1)
                put_entry(b, counts, bin_of(m, over.turn, (uint32_t)x + (uint32_t)__builtin_ctz(bits), (uint32_t)y), id);
    return HOME_MANY;
}

/* Triangles [first, end) of a part, whose homes begin at `homes`. */
static void sort_some(const struct build *b, const struct light_part *part, size_t first, size_t end, uint32_t *homes,
                      uint32_t *counts, uint32_t *wild)
{
    for (size_t i = first; i < end; i++) {
        uint32_t id = part->first_triangle + (uint32_t)i;
        if (!b->filling) {
            light_part_prefetch_vertices(part, id + LIGHT_VERTICES_AHEAD);
            homes[i] = sort_triangle(b, part, id, counts, wild);
        } else if (homes[i] < HOME_MANY) {
            put_entry(b, counts, homes[i], id);
        } else if (homes[i] == HOME_MANY) {
            sort_triangle(b, part, id, counts, wild);
        }
    }
}

static void sort_chunk(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct build *b = context;
    struct geometry_map *m = b->map;
    size_t bins = (size_t)m->tiles * m->tiles * BINS;
    uint32_t *counts = m->counts + chunk * bins, *wild = &b->wild[chunk];
    if (!b->filling)
        memset(counts, 0, bins * sizeof *counts);
    size_t at = 0; /* of the part's first triangle */
    for (size_t p = 0; p < m->mesh.part_count && at < b->starts[chunk + 1]; p++) {
        const struct light_part *part = &m->mesh.parts[p];
        size_t first = at < b->starts[chunk] ? b->starts[chunk] - at : 0;
        size_t end = b->starts[chunk + 1] - at < part->triangle_count ? b->starts[chunk + 1] - at : part->triangle_count;
        sort_some(b, part, first, end, m->homes + at, counts, wild);
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
        for (size_t k = 0; k < BINS * CHUNKS; k++) {
            uint32_t *count = &m->counts[(k % CHUNKS * tiles + tile) * BINS + k / CHUNKS], n = *count;
            *count = (uint32_t)total;
            total += n;
        }
        m->slot[tile] = total > before || wild > 0 ? (uint32_t)slots++ : MAP_NONE;
    }
    if (total >= MAP_NONE)
        return error_set(err, ERROR_TRY_AGAIN, "size", "too many triangles for a map of %u x %u", m->size, m->size);
    m->slot_count = slots;
    size_t texels = slots * MAP_TILE * MAP_TILE;
    size_t note_room = m->slot_room;
    if (!reserve((void **)&m->notes, &note_room, slots, MAP_TILE * MAP_TILE * sizeof *m->notes, err) ||
        !reserve((void **)&m->cells, &m->slot_room, slots, MAP_TILE * MAP_TILE * sizeof *m->cells, err)) {
        m->slot_room = 0;
        return false;
    }
    if (texels > 0)
        memset(m->notes, 0, texels * sizeof *m->notes);
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
    const uint32_t *last = m->counts + (CHUNKS - 1) * (size_t)m->tiles * m->tiles * BINS;
    uint32_t first = tile == 0 ? 0 : last[tile * BINS - 1], end = last[tile * BINS + BINS - 1];
    map_tile_rasterize(m, (uint32_t)(tile % m->tiles), (uint32_t)(tile / m->tiles), m->entries + first, end - first,
                       m->cells + (size_t)m->slot[tile] * MAP_TILE * MAP_TILE);
}

static bool build_tiles(struct geometry_map *m, struct job_pool *pool, struct error *err)
{
    uint32_t wild[CHUNKS] = {0};
    struct build b = {.map = m, .wild = wild};
    for (size_t k = 0; k <= CHUNKS; k++)
        b.starts[k] = m->mesh.triangle_count * k / CHUNKS;
    if (!reserve((void **)&m->homes, &m->home_room, m->mesh.triangle_count, sizeof *m->homes, err))
        return false;
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
    if (!m->slot || !reserve((void **)&m->counts, &m->count_room, (size_t)tiles * tiles * BINS * CHUNKS, sizeof *m->counts, err))
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
    free(m->homes);
    memset(m, 0, sizeof *m);
}

size_t geometry_map_bytes(const struct geometry_map *m)
{
    return light_mesh_bytes(&m->mesh) + (size_t)m->tiles * m->tiles * sizeof *m->slot +
           m->slot_room * MAP_TILE * MAP_TILE * (sizeof *m->cells + sizeof *m->notes) + m->wild_room * sizeof *m->wild +
           m->entry_room * sizeof *m->entries + m->count_room * sizeof *m->counts + m->home_room * sizeof *m->homes;
}
