#include "exact/light_grid.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/job_pool.h"
#include "exact/light_faces.h"

enum {
    CHUNK = 4096,    /* triangles or cells a job */
    SIDE_MAX = 2048, /* cells of level 0 */
    SPAN = 2,        /* cell widths that a triangle's box may span at its level */
    BINS = 1024,     /* of the histogram that level 0 is fitted by */
};
/* Part of the triangles that may lie beyond the fitted range, on each side. */
#define TRIMMED          0.005
/* Entries a triangle to expect: what memory is planned by before they are counted. */
#define LEAST_BYTES_EACH (sizeof(struct light_ref) + 2 * sizeof(uint32_t))

size_t light_grid_least_bytes(const struct triangles *triangles)
{
    return ((size_t)triangles->count + 64) * LEAST_BYTES_EACH * (sizeof(void *) > 4 ? 1 : 1);
}

struct build {
    struct light_grid *grid;
    const struct triangles *triangles;
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
                b->grid->refs[at++] = (struct light_ref){box.u0, box.u1, box.v0, box.v1, box.near, id * b->grid->face_count + f};
}

/* One face and all triangles on it: no need to count. Those that do not count get an empty box. */
static void make_refs_of_one_face(void *context, size_t index, unsigned worker)
{
    (void)worker;
    struct build *b = context;
    uint32_t first = (uint32_t)index * CHUNK, end = chunk_end(first, b->triangles->count);
    struct light_box box;
    for (uint32_t id = first; id < end; id++)
        b->grid->refs[id] = counts_on_face(b, id, &b->grid->faces[0], &box)
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
    grid->refs = malloc(((size_t)total + 1) * sizeof *grid->refs);
    if (grid->refs)
        job_pool_for(pool, chunks, grid->face_count > 1 ? make_refs : make_refs_of_one_face, b);
    return grid->refs != NULL;
}

static unsigned face_of(const struct light_grid *grid, const struct light_ref *ref) { return ref->id % grid->face_count; }
static bool is_empty(const struct light_ref *ref) { return !(ref->u0 <= ref->u1); }

/* Range of the values' bulk: [*low, *high] without the TRIMMED part at either end, by histogram. */
static void bulk_range(const struct light_grid *grid, unsigned face, bool vertical, float *low, float *high)
{
    uint32_t bins[BINS] = {0}, total = 0;
    float least = INFINITY, most = -INFINITY;
    for (int pass = 0; pass < 2; pass++) {
        float scale = most > least ? BINS / (most - least) : 0;
        for (uint32_t i = 0; i < grid->ref_count; i++) {
            const struct light_ref *r = &grid->refs[i];
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
        /* start stays; scale follows the side. */
        face->u_scale *= (float)side / (float)(face->side ? face->side : side);
        face->v_scale *= (float)side / (float)(face->side ? face->side : side);
        face->side = side;
        face->occupied = 0;
        for (unsigned level = 0; side >> level; level++) {
            face->level_first[level] = cells;
            cells += (side >> level) * (side >> level);
        }
    }
    grid->cell_count = cells;
}

/* Cells of level 0 that the ref's box meets, and its level. */
static unsigned place(const struct light_face *face, const struct light_ref *r, uint32_t cells[4])
{
    cells[0] = light_cell(r->u0, face->u_start, face->u_scale, face->side);
    cells[1] = light_cell(r->u1, face->u_start, face->u_scale, face->side);
    cells[2] = light_cell(r->v0, face->v_start, face->v_scale, face->side);
    cells[3] = light_cell(r->v1, face->v_start, face->v_scale, face->side);
    uint32_t wide = cells[1] - cells[0], high = cells[3] - cells[2], most = wide > high ? wide : high;
    unsigned level = 0;
    while ((most >> level) > SPAN - 1 && (face->side >> level) > 1)
        level++;
    return level;
}

/* Calls for each cell of the ref: counts it or puts the ref in. */
static void visit_cells(const struct build *b, uint32_t index, bool fill)
{
    struct light_grid *grid = b->grid;
    const struct light_ref *r = &grid->refs[index];
    if (is_empty(r))
        return;
    const struct light_face *face = &grid->faces[grid->face_count > 1 ? face_of(grid, r) : 0];
    uint32_t cells[4];
    unsigned level = place(face, r, cells);
    for (uint32_t y = cells[2] >> level; y <= cells[3] >> level; y++)
        for (uint32_t x = cells[0] >> level; x <= cells[1] >> level; x++) {
            uint32_t cell = face->level_first[level] + y * (face->side >> level) + x;
            uint32_t at = atomic_fetch_add_explicit(&b->cursor[cell], 1, memory_order_relaxed);
            if (fill)
                grid->entries[at] = index;
        }
}

static void count_entries(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct build *b = context;
    uint32_t first = (uint32_t)chunk * CHUNK, end = chunk_end(first, b->grid->ref_count);
    for (uint32_t i = first; i < end; i++)
        visit_cells(b, i, false);
}

static void fill_entries(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct build *b = context;
    uint32_t first = (uint32_t)chunk * CHUNK, end = chunk_end(first, b->grid->ref_count);
    for (uint32_t i = first; i < end; i++)
        visit_cells(b, i, true);
}

static int compare_refs(const void *first, const void *second, void *refs)
{
    const struct light_ref *a = (const struct light_ref *)refs + *(const uint32_t *)first,
                           *b = (const struct light_ref *)refs + *(const uint32_t *)second;
    if (a->near != b->near)
        return a->near < b->near ? -1 : 1;
    return a->id < b->id ? -1 : a->id > b->id;
}

static void sort_some(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct build *b = context;
    struct light_grid *grid = b->grid;
    uint32_t begin = (uint32_t)chunk * CHUNK, end = chunk_end(begin, grid->cell_count);
    for (uint32_t cell = begin; cell < end; cell++) {
        uint32_t *at = grid->entries + grid->first[cell], count = grid->first[cell + 1] - grid->first[cell];
        if (count > 24) {
            qsort_r(at, count, sizeof *at, compare_refs, grid->refs);
            continue;
        }
        for (uint32_t i = 1; i < count; i++)
            for (uint32_t k = i; k > 0 && compare_refs(&at[k], &at[k - 1], grid->refs) < 0; k--) {
                uint32_t swap = at[k];
                at[k] = at[k - 1];
                at[k - 1] = swap;
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
    }
}

static uint32_t chunks_of(uint32_t count) { return (uint32_t)(((uint64_t)count + CHUNK - 1) / CHUNK); }

/* Counts with the present side; the number of entries. */
static uint64_t count_all(struct build *b, struct job_pool *pool)
{
    struct light_grid *grid = b->grid;
    memset((void *)b->cursor, 0, grid->cell_count * sizeof *b->cursor);
    job_pool_for(pool, chunks_of(grid->ref_count), count_entries, b);
    uint64_t total = 0;
    for (uint32_t i = 0; i < grid->cell_count; i++) {
        uint32_t count = atomic_load_explicit(&b->cursor[i], memory_order_relaxed);
        grid->first[i] = (uint32_t)total;
        atomic_store_explicit(&b->cursor[i], (uint32_t)total, memory_order_relaxed);
        total += count;
    }
    grid->first[grid->cell_count] = (uint32_t)total;
    return total;
}

static uint32_t wanted_side(const struct light_grid *grid)
{
    double cells = grid->ref_count / (double)grid->face_count;
    uint32_t side = 8;
    while (side < SIDE_MAX && (double)side * side < cells)
        side *= 2;
    return side;
}

static size_t bytes_for(const struct light_grid *grid, uint64_t entries)
{
    return grid->ref_count * sizeof *grid->refs + (size_t)entries * sizeof *grid->entries +
           ((size_t)grid->cell_count + 1) * (sizeof *grid->first + sizeof(uint32_t));
}

static bool list_all(struct build *b, size_t memory, struct job_pool *pool)
{
    struct light_grid *grid = b->grid;
    uint32_t side = wanted_side(grid);
    for (unsigned f = 0; f < grid->face_count; f++) {
        struct light_face *face = &grid->faces[f];
        float low, high;
        face->side = side;
        bulk_range(grid, f, false, &low, &high);
        spread(low, high, side, &face->u_start, &face->u_scale);
        bulk_range(grid, f, true, &low, &high);
        spread(low, high, side, &face->v_start, &face->v_scale);
    }
    lay_out(grid, side);
    grid->first = malloc(((size_t)grid->cell_count + 1) * sizeof *grid->first);
    b->cursor = malloc(((size_t)grid->cell_count + 1) * sizeof *b->cursor);
    if (!grid->first || !b->cursor)
        return false;
    uint64_t entries = count_all(b, pool);
    while ((entries >= UINT32_MAX || (memory && bytes_for(grid, entries) > memory)) && side > 1) {
        lay_out(grid, side /= 2);
        entries = count_all(b, pool);
    }
    if (entries >= UINT32_MAX || (memory && bytes_for(grid, entries) > memory))
        return false;
    grid->bytes = bytes_for(grid, entries);
    grid->entries = malloc(((size_t)entries + 1) * sizeof *grid->entries);
    if (!grid->entries)
        return false;
    job_pool_for(pool, chunks_of(grid->ref_count), fill_entries, b);
    job_pool_for(pool, chunks_of(grid->cell_count), sort_some, b);
    mark_occupied(grid);
    return true;
}

/* From id * faces + face back to the id. */
static void strip_faces(struct light_grid *grid)
{
    for (uint32_t i = 0; grid->face_count > 1 && i < grid->ref_count; i++)
        grid->refs[i].id /= grid->face_count;
}

bool light_grid_init(struct light_grid *grid, const struct triangles *triangles, const struct light *light, size_t memory,
                     struct job_pool *pool)
{
    memset(grid, 0, sizeof *grid);
    struct build b = {.grid = grid, .triangles = triangles};
    light_faces_choose(grid, triangles, light);
    bool ok = all_refs(&b, pool) && list_all(&b, memory, pool);
    strip_faces(grid);
    free((void *)b.cursor);
    free(b.chunk_refs);
    return ok;
}

void light_grid_finish(struct light_grid *grid)
{
    free(grid->refs);
    free(grid->first);
    free(grid->entries);
    memset(grid, 0, sizeof *grid);
}
