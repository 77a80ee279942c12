#include "exact/bins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/job_pool.h"
#include "exact/light_grid.h"

/* Chunks are fixed, so that entries come out in the same order whichever thread made them. */
enum { CHUNKS = 16, VERTEX_CHUNK = 8192 };

struct filling {
    struct bins *bins;
    const struct triangles *triangles;
    const struct view *view;
    double sense; /* handedness of the view's axes */
};

static bool grow(void *array, size_t *room, size_t count, size_t size)
{
    void **at = array;
    if (*at && *room >= count)
        return true;
    free(*at);
    *at = malloc(count * size);
    *room = *at ? count : 0;
    return *at != NULL;
}

/* Depth below which a vertex counts as not in front: a little less than near. */
static double front_of(const struct view *v) { return v->orthographic ? -INFINITY : v->near * (1 - 1e-6); }

static void project(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct filling *f = context;
    const struct view *v = f->view;
    size_t end = (chunk + 1) * VERTEX_CHUNK;
    if (end > f->triangles->vertex_count)
        end = f->triangles->vertex_count;
    const double sx = v->width / (v->right_edge - v->left), sy = v->height / (v->bottom - v->top), front = front_of(v);
    for (size_t i = chunk * VERTEX_CHUNK; i < end; i++) {
        struct dvec3 d = dvec3_sub(f->triangles->vertices[i], v->eye);
        double z = dvec3_dot(d, v->forward), k = v->orthographic ? 1 : 1 / z;
        double x = (dvec3_dot(d, v->right) * k - v->left) * sx, y = (dvec3_dot(d, v->up) * k - v->top) * sy;
        bool ok = z >= front;
        /* The axes are unit and orthogonal to within some roundings only. */
        double room = 0x1p-30 * (fabs(d.x) + fabs(d.y) + fabs(d.z)), nearest = z - room;
        f->bins->corners[i][0] = ok ? (float)x : NAN;
        f->bins->corners[i][1] = ok ? (float)y : NAN;
        f->bins->corners[i][2] = v->orthographic ? box_above(-nearest) : nearest > 0 ? box_above(1 / nearest) : INFINITY;
    }
}

static const struct bin_range nowhere = {1, 0, 1, 0, 0};

/* First and last tile that [low, high] in pixels meets; false: none of `count`. */
static bool tile_span(float low, float high, uint32_t pixels, uint16_t *first, uint16_t *last)
{
    low -= BIN_MARGIN * (1 + fabsf(low));
    high += BIN_MARGIN * (1 + fabsf(high));
    if (!(high > 0) || !(low < (float)pixels))
        return false;
    *first = low > 0 ? (uint16_t)((uint32_t)low / TILE_SIDE) : 0;
    *last = (uint16_t)((high < (float)(pixels - 1) ? (uint32_t)high : pixels - 1) / TILE_SIDE);
    return true;
}

/* The part in front of the near plane: its box in picture positions. */
static bool box_of_clipped(const struct filling *f, const struct dvec3 c[3], float box[4])
{
    const struct view *v = f->view;
    const double sx = v->width / (v->right_edge - v->left), sy = v->height / (v->bottom - v->top), front = front_of(v);
    double z[3];
    if (v->orthographic) {
        box[0] = box[2] = -INFINITY, box[1] = box[3] = INFINITY;
        return true;
    }
    box[0] = box[2] = INFINITY, box[1] = box[3] = -INFINITY;
    for (int i = 0; i < 3; i++)
        z[i] = dvec3_dot(dvec3_sub(c[i], v->eye), v->forward);
    for (int i = 0; i < 3; i++) {
        int k = (i + 1) % 3;
        struct dvec3 ends[2] = {c[i], c[k]};
        if (z[i] < front && z[k] < front)
            continue;
        if ((z[i] < front) != (z[k] < front)) {
            struct dvec3 cut = dvec3_mad(c[i], dvec3_sub(c[k], c[i]), (front - z[i]) / (z[k] - z[i]));
            ends[z[i] < front ? 0 : 1] = cut;
        }
        for (int e = 0; e < 2; e++) {
            struct dvec3 d = dvec3_sub(ends[e], v->eye);
            /* A cut end lies on the plane, whatever its rounding. */
            double depth = fmax(dvec3_dot(d, v->forward), front);
            double x = (dvec3_dot(d, v->right) / depth - v->left) * sx, y = (dvec3_dot(d, v->up) / depth - v->top) * sy;
            box[0] = box_min(box[0], (float)x), box[1] = box_max(box[1], (float)x);
            box[2] = box_min(box[2], (float)y), box[3] = box_max(box[3], (float)y);
        }
    }
    /* The cut's own rounding, at most 2^-40 of the corners' distance; seen from near, so a generous piece of the picture. */
    double far = 0;
    for (int i = 0; i < 3; i++)
        far = fmax(far, dvec3_length(dvec3_sub(c[i], v->eye)));
    float margin = (float)(0x1p-40 * far / v->near * (fabs(sx) + fabs(sy)));
    box[0] -= margin, box[1] += margin, box[2] -= margin, box[3] += margin;
    return box[0] <= box[1];
}

/* True when the triangle certainly shows the camera a side that is hidden. Seen in front of the eye, N . d > 0 where the corners run
 * clockwise in a picture whose y points down (right-handed axes). */
static bool is_hidden(const struct filling *f, unsigned flags, const float *a, const float *b, const float *c)
{
    if (!(flags & (TRIANGLE_HIDDEN_BACK | TRIANGLE_HIDDEN_MIRRORED)))
        return false;
    float ux = b[0] - a[0], uy = b[1] - a[1], vx = c[0] - a[0], vy = c[1] - a[1];
    float most = box_max(box_max(fabsf(a[0]) + fabsf(a[1]), fabsf(b[0]) + fabsf(b[1])), fabsf(c[0]) + fabsf(c[1])) + 1;
    float size = fabsf(ux) + fabsf(uy) + fabsf(vx) + fabsf(vy);
    float area = (ux * vy - uy * vx) * (float)f->sense, error = 0x1p-20f * most * size + 0x1p-36f * most * most;
    return flags & TRIANGLE_HIDDEN_BACK ? area > error : area < -error;
}

static struct bin_range range_of(const struct filling *f, uint32_t id)
{
    const struct triangles *t = f->triangles;
    const float *a = f->bins->corners[t->corners[id][0]], *b = f->bins->corners[t->corners[id][1]],
                *c = f->bins->corners[t->corners[id][2]];
    struct bin_range r = {.nearest = INFINITY};
    float box[4];
    if (t->flags[id] & TRIANGLE_IGNORED)
        return nowhere;
    if (isnan(a[0] + b[0] + c[0])) {
        struct dvec3 corners[3];
        triangle_corners(t, id, corners);
        if (!box_of_clipped(f, corners, box))
            return nowhere;
    } else {
        if (is_hidden(f, t->flags[id], a, b, c))
            return nowhere;
        r.nearest = box_max(box_max(a[2], b[2]), c[2]);
        box[0] = box_min(box_min(a[0], b[0]), c[0]), box[1] = box_max(box_max(a[0], b[0]), c[0]);
        box[2] = box_min(box_min(a[1], b[1]), c[1]), box[3] = box_max(box_max(a[1], b[1]), c[1]);
    }
    if (!tile_span(box[0], box[1], f->view->width, &r.left, &r.right) ||
        !tile_span(box[2], box[3], f->view->height, &r.top, &r.bottom))
        return nowhere;
    return r;
}

static uint32_t chunk_start(const struct triangles *t, size_t chunk) { return (uint32_t)((uint64_t)t->count * chunk / CHUNKS); }

static void count_chunk(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct filling *f = context;
    struct bins *b = f->bins;
    uint32_t *counts = b->counts + chunk * b->columns * b->rows;
    for (uint32_t id = chunk_start(f->triangles, chunk), end = chunk_start(f->triangles, chunk + 1); id < end; id++) {
        struct bin_range r = b->ranges[id] = range_of(f, id);
        if (r.left > r.right)
            continue;
        for (uint32_t y = r.top; y <= r.bottom; y++)
            for (uint32_t x = r.left; x <= r.right; x++)
                counts[y * b->columns + x]++;
    }
}

static void fill_chunk(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct filling *f = context;
    struct bins *b = f->bins;
    uint32_t *cursor = b->counts + chunk * b->columns * b->rows;
    for (uint32_t id = chunk_start(f->triangles, chunk), end = chunk_start(f->triangles, chunk + 1); id < end; id++) {
        struct bin_range r = b->ranges[id];
        if (r.left > r.right)
            continue;
        for (uint32_t y = r.top; y <= r.bottom; y++)
            for (uint32_t x = r.left; x <= r.right; x++)
                b->entries[cursor[y * b->columns + x]++] = (struct bin_entry){id, r.nearest};
    }
}

static bool place_chunks(struct bins *b)
{
    uint32_t tiles = b->columns * b->rows;
    uint64_t total = 0, most = 0;
    for (uint32_t tile = 0; tile < tiles; tile++) {
        uint64_t before = total;
        b->first[tile] = (uint32_t)total;
        for (size_t chunk = 0; chunk < CHUNKS; chunk++) {
            uint32_t count = b->counts[chunk * tiles + tile];
            b->counts[chunk * tiles + tile] = (uint32_t)total;
            total += count;
        }
        most = total - before > most ? total - before : most;
    }
    b->most = (uint32_t)most;
    b->first[tiles] = (uint32_t)total;
    return total < UINT32_MAX && grow(&b->entries, &b->entry_room, (size_t)total + 1, sizeof *b->entries);
}

bool bins_fill(struct bins *b, const struct triangles *t, const struct view *view, struct job_pool *pool)
{
    b->columns = (view->width + TILE_SIDE - 1) / TILE_SIDE;
    b->rows = (view->height + TILE_SIDE - 1) / TILE_SIDE;
    size_t tiles = (size_t)b->columns * b->rows;
    if (b->tile_room < tiles) {
        free(b->first);
        free(b->counts);
        b->first = malloc((tiles + 1) * sizeof *b->first);
        b->counts = malloc(tiles * CHUNKS * sizeof *b->counts);
        b->tile_room = b->first && b->counts ? tiles : 0;
    }
    if (!b->tile_room || !grow(&b->corners, &b->vertex_room, t->vertex_count + 1, sizeof *b->corners) ||
        !grow(&b->ranges, &b->triangle_room, (size_t)t->count + 1, sizeof *b->ranges))
        return false;
    memset(b->counts, 0, tiles * CHUNKS * sizeof *b->counts);
    struct filling f = {.bins = b, .triangles = t, .view = view};
    /* Right x up = -forward in a right-handed frame. */
    f.sense = dvec3_dot(dvec3_cross(view->right, view->up), view->forward) < 0 ? 1 : -1;
    job_pool_for(pool, (t->vertex_count + VERTEX_CHUNK - 1) / VERTEX_CHUNK, project, &f);
    job_pool_for(pool, CHUNKS, count_chunk, &f);
    if (!place_chunks(b))
        return false;
    job_pool_for(pool, CHUNKS, fill_chunk, &f);
    return true;
}

void bins_finish(struct bins *b)
{
    free(b->corners);
    free(b->ranges);
    free(b->first);
    free(b->counts);
    free(b->entries);
    memset(b, 0, sizeof *b);
}

size_t bins_bytes(const struct bins *b)
{
    return b->vertex_room * sizeof *b->corners + b->triangle_room * sizeof *b->ranges +
           b->tile_room * (1 + CHUNKS) * sizeof *b->first + b->entry_room * sizeof *b->entries;
}
