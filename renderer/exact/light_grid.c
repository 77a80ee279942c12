#include "exact/light_grid.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/job_pool.h"
#include "exact/light_faces.h"

enum {
    CHUNK = 4096,    /* triangles or cells a job */
    SIDE_MAX = 2048, /* cells of level 0 */
    BLOCKS_MAX = 64, /* blocks that one box is written to */
    BINS = 1024,     /* of the histogram that level 0 is fitted by */
};
/* Part of the triangles that may lie beyond the fitted range, on each side. */
#define TRIMMED 0.005

/* A triangle on a face, before it has its place. */
struct light_ref {
    float u0, u1, v0, v1, near;
    uint32_t id;
    uint32_t cell;
};

enum { REF_BYTES = 5 * sizeof(float) + sizeof(uint32_t), KNOWN_BYTES = 1 + LIGHT_OTHERS * sizeof(uint32_t) };

size_t light_grid_least_bytes(const struct triangles *triangles)
{
    return ((size_t)triangles->count + LIGHT_PADDING) * (REF_BYTES + sizeof(struct light_ref) + KNOWN_BYTES) + 4096;
}

struct build {
    struct light_grid *grid;
    const struct triangles *triangles;
    struct light_ref *refs;
    uint32_t *chunk_refs;     /* refs of each chunk of triangles; then where they start */
    _Atomic uint32_t *cursor; /* of each cell */
};

static bool counts_on_face(const struct build *b, uint32_t id, const struct light_face *face, struct light_box *box)
{
    struct dvec3 corners[3];
    if (b->triangles->flags[id] & TRIANGLE_IGNORED)
        return false;
    triangle_corners(b->triangles, id, corners);
    return light_face_box(b->grid, face, corners, 3, 0, box) == FACE_SOME;
}

static uint32_t chunk_end(uint32_t first, uint32_t count) { return count - first < CHUNK ? count : first + CHUNK; }

static void count_refs(void *context, size_t index, unsigned worker)
{
    (void)worker;
    struct build *b = context;
    uint32_t first = (uint32_t)index * CHUNK, end = chunk_end(first, b->triangles->count), refs = 0;
    struct light_box box;
    for (uint32_t id = first; id < end; id++)
        for (unsigned f = 0; f < b->grid->face_count; f++)
            refs += counts_on_face(b, id, &b->grid->faces[f], &box);
    b->chunk_refs[index] = refs;
}

/* The face's number is kept in the ref's id while the grid is built: by order, faces of a triangle ascend. */
static void make_refs(void *context, size_t index, unsigned worker)
{
    (void)worker;
    struct build *b = context;
    uint32_t first = (uint32_t)index * CHUNK, end = chunk_end(first, b->triangles->count), at = b->chunk_refs[index];
    struct light_box box;
    for (uint32_t id = first; id < end; id++)
        for (unsigned f = 0; f < b->grid->face_count; f++)
            if (counts_on_face(b, id, &b->grid->faces[f], &box))
                b->refs[at++] = (struct light_ref){box.u0, box.u1, box.v0, box.v1, box.near, id * b->grid->face_count + f};
}

/* One face and all triangles on it: no need to count. Those that do not count get an empty box. */
static void make_refs_of_one_face(void *context, size_t index, unsigned worker)
{
    (void)worker;
    struct build *b = context;
    uint32_t first = (uint32_t)index * CHUNK, end = chunk_end(first, b->triangles->count);
    struct light_box box;
    for (uint32_t id = first; id < end; id++)
        b->refs[id] = counts_on_face(b, id, &b->grid->faces[0], &box)
                          ? (struct light_ref){box.u0, box.u1, box.v0, box.v1, box.near, id}
                          : (struct light_ref){INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY, id};
}

static bool all_refs(struct build *b, struct job_pool *pool)
{
    struct light_grid *grid = b->grid;
    uint32_t chunks = (b->triangles->count + CHUNK - 1) / CHUNK;
    uint64_t total = b->triangles->count;
    b->chunk_refs = calloc((size_t)chunks + 1, sizeof *b->chunk_refs);
    if (!b->chunk_refs)
        return false;
    if (grid->face_count > 1) {
        job_pool_for(pool, chunks, count_refs, b);
        total = 0;
        for (uint32_t i = 0; i < chunks; i++) {
            uint32_t refs = b->chunk_refs[i];
            b->chunk_refs[i] = (uint32_t)total;
            total += refs;
        }
    }
    if (total * LIGHT_FACES_MAX >= UINT32_MAX || (uint64_t)b->triangles->count * LIGHT_FACES_MAX >= UINT32_MAX)
        return false;
    grid->ref_count = (uint32_t)total;
    b->refs = malloc(((size_t)total + 1) * sizeof *b->refs);
    if (b->refs)
        job_pool_for(pool, chunks, grid->face_count > 1 ? make_refs : make_refs_of_one_face, b);
    return b->refs != NULL;
}

static unsigned face_of(const struct light_grid *grid, const struct light_ref *ref) { return ref->id % grid->face_count; }
static bool is_empty(const struct light_ref *ref) { return !(ref->u0 <= ref->u1); }

/* Range of the values' bulk: [*low, *high] without the TRIMMED part at either end, by histogram; of many, every sixteenth will do. */
static void bulk_range(const struct build *b, unsigned face, bool vertical, float *low, float *high)
{
    const struct light_grid *grid = b->grid;
    uint32_t bins[BINS] = {0}, total = 0;
    float least = INFINITY, most = -INFINITY;
    const uint32_t step = grid->ref_count > 64 * BINS ? 16 : 1;
    for (int pass = 0; pass < 2; pass++) {
        float scale = most > least ? BINS / (most - least) : 0;
        for (uint32_t i = 0; i < grid->ref_count; i += step) {
            const struct light_ref *r = &b->refs[i];
            float middle = vertical ? 0.5f * (r->v0 + r->v1) : 0.5f * (r->u0 + r->u1);
            if (is_empty(r) || !isfinite(middle) || (grid->face_count > 1 && face_of(grid, r) != face))
                continue;
            if (pass == 0) {
                least = fminf(least, middle);
                most = fmaxf(most, middle);
            } else {
                bins[light_cell(middle, least, scale, BINS)]++;
                total++;
            }
        }
    }
    uint32_t trim = (uint32_t)(total * TRIMMED), from = 0, to = BINS - 1;
    for (uint32_t sum = 0; from < to && (sum += bins[from]) <= trim; from++)
        ;
    for (uint32_t sum = 0; to > from && (sum += bins[to]) <= trim; to--)
        ;
    *low = total ? least + (most - least) * ((float)from / BINS) : 0;
    *high = total ? least + (most - least) * ((float)(to + 1) / BINS) : 1;
}

static void spread(float low, float high, uint32_t side, float *start, float *scale)
{
    float width = high - low;
    *start = low;
    *scale = width > 0 ? (float)side / width : 1;
    if (!isfinite(*scale) || !isfinite(*start))
        *start = 0, *scale = 1;
}

static void lay_out(struct light_grid *grid, uint32_t side)
{
    uint32_t cells = 0;
    for (unsigned f = 0; f < grid->face_count; f++) {
        struct light_face *face = &grid->faces[f];
        face->occupied = 0;
        for (unsigned level = 0; side >> level; level++) {
            face->level_first[level] = cells;
            cells += (side >> level) * (side >> level);
        }
    }
    grid->cell_count = cells;
}

/* Widths of the levels' cells, less what rounding might add to a box's; the last level takes all. */
static void set_reaches(struct light_face *face)
{
    for (unsigned level = 0; face->side >> level; level++) {
        bool last = (face->side >> level) == 1;
        face->reach_u[level] = last ? INFINITY : (float)(1u << level) / face->u_scale;
        face->reach_v[level] = last ? INFINITY : (float)(1u << level) / face->v_scale;
    }
}

static unsigned level_of(const struct light_face *face, const struct light_ref *r)
{
    unsigned level = 0;
    float wide = (r->u1 - r->u0) * 1.0001f, high = (r->v1 - r->v0) * 1.0001f;
    while (!(wide <= face->reach_u[level] && high <= face->reach_v[level]) && (face->side >> level) > 1)
        level++;
    return level;
}

static uint32_t cell_of(const struct light_face *face, const struct light_ref *r, unsigned level)
{
    return face->level_first[level] +
           (light_cell(r->v0, face->v_start, face->v_scale, face->side) >> level) * (face->side >> level) +
           (light_cell(r->u0, face->u_start, face->u_scale, face->side) >> level);
}

static void mark_blocks(const struct light_grid *grid, unsigned f, const struct light_ref *r, unsigned level)
{
    const struct light_face *face = &grid->faces[f];
    uint32_t side = light_blocks(face);
    _Atomic uint16_t *blocks = grid->blocks + (size_t)f * side * side;
    uint32_t x0 = light_cell(r->u0, face->u_start, face->u_scale, face->side) >> LIGHT_BLOCK_SHIFT,
             x1 = light_cell(r->u1, face->u_start, face->u_scale, face->side) >> LIGHT_BLOCK_SHIFT,
             y0 = light_cell(r->v0, face->v_start, face->v_scale, face->side) >> LIGHT_BLOCK_SHIFT,
             y1 = light_cell(r->v1, face->v_start, face->v_scale, face->side) >> LIGHT_BLOCK_SHIFT;
    if ((x1 - x0 + 1) * (uint64_t)(y1 - y0 + 1) > BLOCKS_MAX)
        return;
    for (uint32_t y = y0; y <= y1; y++)
        for (uint32_t x = x0; x <= x1; x++) {
            _Atomic uint16_t *block = &blocks[y * side + x];
            if (!(atomic_load_explicit(block, memory_order_relaxed) >> level & 1))
                atomic_fetch_or_explicit(block, (uint16_t)(1u << level), memory_order_relaxed);
        }
}

/* Levels whose boxes may be too large to be marked. */
static uint32_t unmarked_levels(const struct light_face *face)
{
    uint32_t levels = 0;
    for (unsigned level = 0; face->side >> level; level++) {
        /* A box of the level meets at most so many blocks a side, one more for where it starts and one for rounding. */
        uint32_t most = (1u << level >> LIGHT_BLOCK_SHIFT) + 3;
        levels |= (uint32_t)(most * most > BLOCKS_MAX || (face->side >> level) == 1) << level;
    }
    return levels;
}

static void count_refs_of_cells(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct build *b = context;
    const struct light_grid *grid = b->grid;
    uint32_t first = (uint32_t)chunk * CHUNK, end = chunk_end(first, grid->ref_count);
    for (uint32_t i = first; i < end; i++) {
        struct light_ref *r = &b->refs[i];
        if (is_empty(r))
            continue;
        unsigned f = grid->face_count > 1 ? face_of(grid, r) : 0, level = level_of(&grid->faces[f], r);
        r->cell = cell_of(&grid->faces[f], r, level);
        mark_blocks(grid, f, r, level);
        atomic_fetch_add_explicit(&b->cursor[r->cell], 1, memory_order_relaxed);
    }
}

/* Indices of refs go into `ids` first: sorted by then. */
static void place_refs(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct build *b = context;
    uint32_t first = (uint32_t)chunk * CHUNK, end = chunk_end(first, b->grid->ref_count);
    for (uint32_t i = first; i < end; i++)
        if (!is_empty(&b->refs[i]))
            b->grid->ids[atomic_fetch_add_explicit(&b->cursor[b->refs[i].cell], 1, memory_order_relaxed)] = i;
}

static int compare_indices(const void *first, const void *second)
{
    uint32_t a = *(const uint32_t *)first, b = *(const uint32_t *)second;
    return a < b ? -1 : a > b;
}

static void sort_cell(uint32_t *at, uint32_t count)
{
    if (count > 24) {
        qsort(at, count, sizeof *at, compare_indices);
        return;
    }
    for (uint32_t i = 1; i < count; i++)
        for (uint32_t k = i; k > 0 && at[k] < at[k - 1]; k--) {
            uint32_t swap = at[k];
            at[k] = at[k - 1];
            at[k - 1] = swap;
        }
}

static void write_cells(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct build *b = context;
    struct light_grid *grid = b->grid;
    uint32_t begin = (uint32_t)chunk * CHUNK, end = chunk_end(begin, grid->cell_count);
    for (uint32_t cell = begin; cell < end; cell++) {
        sort_cell(grid->ids + grid->first[cell], grid->first[cell + 1] - grid->first[cell]);
        for (uint32_t i = grid->first[cell]; i < grid->first[cell + 1]; i++) {
            const struct light_ref *r = &b->refs[grid->ids[i]];
            grid->u0[i] = r->u0, grid->u1[i] = r->u1, grid->v0[i] = r->v0, grid->v1[i] = r->v1, grid->near[i] = r->near;
            grid->ids[i] = grid->face_count > 1 ? r->id / grid->face_count : r->id;
        }
    }
}

static void mark_occupied(struct light_grid *grid)
{
    for (unsigned f = 0; f < grid->face_count; f++) {
        struct light_face *face = &grid->faces[f];
        for (unsigned level = 0; face->side >> level; level++) {
            uint32_t cells = (face->side >> level) * (face->side >> level), from = face->level_first[level];
            face->occupied |= (uint32_t)(grid->first[from + cells] > grid->first[from]) << level;
        }
        face->everywhere = face->occupied & unmarked_levels(face);
    }
}

static uint32_t chunks_of(uint32_t count) { return (uint32_t)(((uint64_t)count + CHUNK - 1) / CHUNK); }

static void count_cells(struct build *b, struct job_pool *pool)
{
    struct light_grid *grid = b->grid;
    memset((void *)b->cursor, 0, grid->cell_count * sizeof *b->cursor);
    job_pool_for(pool, chunks_of(grid->ref_count), count_refs_of_cells, b);
    uint32_t total = 0;
    for (uint32_t i = 0; i < grid->cell_count; i++) {
        uint32_t count = atomic_load_explicit(&b->cursor[i], memory_order_relaxed);
        grid->first[i] = total;
        atomic_store_explicit(&b->cursor[i], total, memory_order_relaxed);
        total += count;
    }
    grid->first[grid->cell_count] = total;
}

static uint32_t wanted_side(const struct light_grid *grid)
{
    /* Measured on dragon, grove, oaks, wires: a quarter of that is as fast, four times as many cells a fifth slower on the grove. */
    double cells = 0.01 * grid->ref_count / grid->face_count;
    uint32_t side = 8;
    while (side < SIDE_MAX && (double)side * side < cells)
        side *= 2;
    return side;
}

/* While it is built; afterwards the refs and a word a cell are free again. */
static size_t bytes_for(const struct light_grid *grid, uint32_t side)
{
    size_t cells = (size_t)side * side * 4 / 3 * grid->face_count;
    return ((size_t)grid->ref_count + LIGHT_PADDING) * (REF_BYTES + sizeof(struct light_ref) + KNOWN_BYTES) +
           cells * 2 * sizeof(uint32_t);
}

static void fit_faces(struct build *b, uint32_t side)
{
    for (unsigned f = 0; f < b->grid->face_count; f++) {
        struct light_face *face = &b->grid->faces[f];
        float low, high;
        bulk_range(b, f, false, &low, &high);
        spread(low, high, side, &face->u_start, &face->u_scale);
        bulk_range(b, f, true, &low, &high);
        spread(low, high, side, &face->v_start, &face->v_scale);
        face->side = side;
        set_reaches(face);
    }
    lay_out(b->grid, side);
}

static float *floats(const struct light_grid *grid) { return calloc((size_t)grid->ref_count + LIGHT_PADDING, sizeof(float)); }

static bool allocate(struct build *b)
{
    struct light_grid *grid = b->grid;
    grid->u0 = floats(grid), grid->u1 = floats(grid), grid->v0 = floats(grid), grid->v1 = floats(grid), grid->near = floats(grid);
    uint32_t blocks = light_blocks(&grid->faces[0]);
    grid->blocks = calloc((size_t)blocks * blocks * grid->face_count, sizeof *grid->blocks);
    grid->known = calloc((size_t)b->triangles->count + 1, sizeof *grid->known);
    grid->others = malloc(((size_t)b->triangles->count + 1) * sizeof *grid->others);
    grid->ids = calloc((size_t)grid->ref_count + LIGHT_PADDING, sizeof *grid->ids);
    grid->first = malloc(((size_t)grid->cell_count + 1) * sizeof *grid->first);
    b->cursor = malloc(((size_t)grid->cell_count + 1) * sizeof *b->cursor);
    return grid->u0 && grid->u1 && grid->v0 && grid->v1 && grid->near && grid->ids && grid->blocks && grid->known &&
           grid->others && grid->first && b->cursor;
}

static bool list_all(struct build *b, size_t memory, struct job_pool *pool)
{
    struct light_grid *grid = b->grid;
    uint32_t side = wanted_side(grid);
    while (memory && bytes_for(grid, side) > memory && side > 1)
        side /= 2;
    if (memory && bytes_for(grid, side) > memory)
        return false;
    fit_faces(b, side);
    if (!allocate(b))
        return false;
    grid->bytes =
        ((size_t)grid->ref_count + LIGHT_PADDING) * REF_BYTES + grid->cell_count * sizeof *grid->first + b->triangles->count;
    count_cells(b, pool);
    job_pool_for(pool, chunks_of(grid->ref_count), place_refs, b);
    job_pool_for(pool, chunks_of(grid->cell_count), write_cells, b);
    mark_occupied(grid);
    return true;
}

bool light_grid_init(struct light_grid *grid, const struct triangles *triangles, const struct light *light, size_t memory,
                     struct job_pool *pool)
{
    memset(grid, 0, sizeof *grid);
    struct build b = {.grid = grid, .triangles = triangles};
    light_faces_choose(grid, triangles, light);
    bool ok = all_refs(&b, pool) && list_all(&b, memory, pool);
    free((void *)b.cursor);
    free(b.chunk_refs);
    free(b.refs);
    return ok;
}

void light_grid_finish(struct light_grid *grid)
{
    free(grid->u0);
    free(grid->u1);
    free(grid->v0);
    free(grid->v1);
    free(grid->near);
    free(grid->ids);
    free((void *)grid->others);
    free((void *)grid->known);
    free((void *)grid->blocks);
    free(grid->first);
    memset(grid, 0, sizeof *grid);
}
