#include "shadow/geometry/geometry_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "shadow/geometry/light_lanes.h"
#include "shadow/geometry/map_tile.h"

/* Triangles are sorted in parts, one after the other in every bin, so that it does not matter how many: each has a count per bin, which one
 * thread adds up. */
enum { CHUNKS_A_THREAD = 4, CHUNKS_MAX = 32 };

/* A tile has two bins: triangles that turn clockwise and those that turn the other way. Where a mesh is closed, one of them is hidden by the
 * other, which is rasterized first. */
enum { BINS = 2 };
/* Where a triangle goes: a bin (at most 2 * 512 * 512 of them), and whether to the tiles right of it and below too. */
#define HOME_RIGHT 0x40000000u
#define HOME_BELOW 0x80000000u
#define HOME_NONE  0x3fffffffu /* touches no tile */
#define HOME_MANY  0x3ffffffeu /* more tiles, or wild */
#define HOME_BIN   0x3fffffffu

#define INLINE static inline __attribute__((always_inline))

struct build {
    struct geometry_map *map;
    size_t chunks, starts[CHUNKS_MAX + 1]; /* of each chunk, in the order of the mesh's triangles */
    bool filling;                          /* second sweep: put entries where the first one's counts say */
    uint32_t *wild;                        /* of each chunk, of the first sweep: how many */
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
    return (y * m->tiles + x) * BINS + (area < 0 ? 0 : 1); /* as find_homes() has it */
}

static void put_entry(const struct build *b, uint32_t *counts, uint32_t bin, uint32_t id)
{
    if (b->filling)
        b->map->entries[counts[bin]] = id;
    counts[bin]++;
}

/* A home's two to four bins where it has flags. */
static void put_home(const struct build *b, uint32_t *counts, uint32_t home, uint32_t id)
{
    uint32_t bin = home & HOME_BIN, below = b->map->tiles * BINS;
    put_entry(b, counts, bin, id);
    if (home & HOME_RIGHT)
        put_entry(b, counts, bin + BINS, id);
    if (home & HOME_BELOW)
        put_entry(b, counts, bin + below, id);
    if ((home & HOME_RIGHT) && (home & HOME_BELOW))
        put_entry(b, counts, bin + below + BINS, id);
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
    if (!over_tiles(m, &t, &over))
        return HOME_NONE;
    for (int32_t y = over.y0; y <= over.y1; y++)
        for (int32_t x = over.x0; x <= over.x1; x += LANES)
            for (unsigned bits = conservative_row(&over, x, y); bits; bits &= bits - 1)
                put_entry(b, counts, bin_of(m, over.turn, (uint32_t)x + (uint32_t)__builtin_ctz(bits), (uint32_t)y), id);
    return HOME_MANY;
}

/* Homes of eight triangles on the map within two tiles by two, by their boxes: most are. Else HOME_MANY. */
INLINE void find_homes(const struct geometry_map *m, const struct light_triangle t[LANES], uint32_t *homes)
{
    struct light_lanes at;
    light_lanes_load(t, &at);
    const float side = (float)m->size;
    lanes left = LANES_LEAST(at.x) - CONSERVATIVE_MARGIN, right = LANES_MOST(at.x) + CONSERVATIVE_MARGIN;
    lanes top = LANES_LEAST(at.y) - CONSERVATIVE_MARGIN, bottom = LANES_MOST(at.y) + CONSERVATIVE_MARGIN;
    /* Sums, since a lane that is not a number is wild. */
    lanes sum = at.x[0] + at.x[1] + at.x[2];
    lane_ints few = (left >= 0) & (top >= 0) & (right < side) & (bottom < side) & (sum == sum);
    /* Others become 0: what a wild lane makes as a whole number is anything. */
    lanes *const ends[] = {&left, &right, &top, &bottom};
    for (int i = 0; i < 4; i++)
        *ends[i] = (lanes)((lane_ints)*ends[i] & few);
    lane_ints column = lanes_truncate(left) / (int32_t)MAP_TILE, row = lanes_truncate(top) / (int32_t)MAP_TILE;
    lane_ints more = lanes_truncate(right) / (int32_t)MAP_TILE - column, lower = lanes_truncate(bottom) / (int32_t)MAP_TILE - row;
    few &= (more <= 1) & (lower <= 1);
    lanes area = (at.x[1] - at.x[0]) * (at.y[2] - at.y[0]) - (at.x[2] - at.x[0]) * (at.y[1] - at.y[0]);
    lane_ints bin = (row * (int32_t)m->tiles + column) * BINS + ((area < 0) + 1);
    bin |= (lane_ints)((lane_uints)(more & few) << 30 | (lane_uints)(lower & few) << 31);
    *(lane_ints_anywhere *)homes = (bin & few) | (~few & (int32_t)HOME_MANY);
}

/* Triangles [first, end) of a part, whose homes begin at `homes`. */
INLINE void find_some_homes(const struct geometry_map *m, const struct light_part *part, size_t first, size_t end,
                            uint32_t *homes)
{
    for (size_t i = first; i < end; i += LANES) {
        struct light_triangle t[LANES];
        uint32_t found[LANES];
        size_t count = end - i < LANES ? end - i : LANES;
        for (size_t k = 0; k < LANES; k++)
            t[k] = light_part_triangle(part, part->first_triangle + (uint32_t)(i + (k < count ? k : 0)));
        find_homes(m, t, found);
        memcpy(homes + i, found, count * sizeof *found);
    }
}

#ifdef __x86_64__
__attribute__((target("avx2"))) static void find_some_homes_avx2(const struct geometry_map *m, const struct light_part *part,
                                                                 size_t first, size_t end, uint32_t *homes)
{
    find_some_homes(m, part, first, end, homes);
}
#endif

static void find_some_homes_any(const struct geometry_map *m, const struct light_part *part, size_t first, size_t end,
                                uint32_t *homes)
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        find_some_homes_avx2(m, part, first, end, homes);
        return;
    }
#endif
    find_some_homes(m, part, first, end, homes);
}

static void sort_some(const struct build *b, const struct light_part *part, size_t first, size_t end, uint32_t *homes,
                      uint32_t *counts, uint32_t *wild)
{
    if (!b->filling)
        find_some_homes_any(b->map, part, first, end, homes);
    for (size_t i = first; i < end; i++) {
        uint32_t id = part->first_triangle + (uint32_t)i, home = homes[i];
        if (home == HOME_MANY)
            homes[i] = sort_triangle(b, part, id, counts, wild);
        else if (home != HOME_NONE)
            put_home(b, counts, home, id);
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
    for (size_t chunk = 0; chunk < b->chunks; chunk++) {
        uint32_t count = b->wild[chunk];
        b->wild[chunk] = wild;
        wild += count;
    }
    m->wild_count = wild;
    for (size_t tile = 0; tile < tiles; tile++) {
        size_t before = total;
        for (size_t bin = tile * BINS; bin < (tile + 1) * BINS; bin++)
            for (size_t chunk = 0; chunk < b->chunks; chunk++) {
                uint32_t *count = &m->counts[chunk * tiles * BINS + bin], n = *count;
                *count = (uint32_t)total;
                total += n;
            }
        m->slot[tile] = total > before || wild > 0 ? (uint32_t)slots++ : MAP_NONE;
    }
    if (total >= MAP_NONE)
        return error_set(err, ERROR_TRY_AGAIN, "size", "too many triangles for a map of %u x %u", m->size, m->size);
    m->slot_count = slots;
    size_t note_room = m->slot_room;
    if (!reserve((void **)&m->notes, &note_room, slots, MAP_TILE * MAP_TILE * sizeof *m->notes, err) ||
        !reserve((void **)&m->cells, &m->slot_room, slots, MAP_TILE * MAP_TILE * sizeof *m->cells, err)) {
        m->slot_room = 0;
        return false;
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
    const uint32_t *last = m->counts + (b->chunks - 1) * (size_t)m->tiles * m->tiles * BINS;
    uint32_t first = tile == 0 ? 0 : last[tile * BINS - 1], front = last[tile * BINS], end = last[tile * BINS + 1];
    size_t texel = (size_t)m->slot[tile] * MAP_TILE * MAP_TILE;
    memset(m->notes + texel, 0, MAP_TILE * MAP_TILE * sizeof *m->notes);
    map_tile_choose()(m, (uint32_t)(tile % m->tiles), (uint32_t)(tile / m->tiles), m->entries + first, front - first, end - first,
                      m->cells + texel);
}

static bool build_tiles(struct geometry_map *m, struct job_pool *pool, struct error *err)
{
    uint32_t wild[CHUNKS_MAX] = {0};
    size_t chunks = (size_t)job_pool_threads(pool) * CHUNKS_A_THREAD, bins = (size_t)m->tiles * m->tiles * BINS;
    struct build b = {.map = m, .chunks = chunks < CHUNKS_MAX ? chunks : CHUNKS_MAX, .wild = wild};
    for (size_t k = 0; k <= b.chunks; k++)
        b.starts[k] = m->mesh.triangle_count * k / b.chunks;
    if (!reserve((void **)&m->counts, &m->count_room, bins * b.chunks, sizeof *m->counts, err) ||
        !reserve((void **)&m->homes, &m->home_room, m->mesh.triangle_count, sizeof *m->homes, err))
        return false;
    job_pool_for(pool, b.chunks, sort_chunk, &b);
    if (!place_entries(&b, err))
        return false;
    b.filling = true;
    job_pool_for(pool, b.chunks, sort_chunk, &b);
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
    if (!m->slot)
        return out_of_memory(err);
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
