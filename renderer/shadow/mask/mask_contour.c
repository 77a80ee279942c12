#include "shadow/mask/mask_contour.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/job_pool.h"
#include "shadow/geometry/conservative.h"

enum { CHUNK = 8192 }; /* triangles a job */

/* How much a silhouette is widened, texels: more than the rounding of the map's coordinates. */
static const double EDGE_MARGIN = 1.0 / 64;

struct listed {
    uint32_t texel;          /* index of a crossed texel */
    struct mask_entry entry; /* its face counts in the chunk */
};

struct chunk {
    const struct light_part *part;
    uint32_t first, end; /* of the part's triangles */
    ARRAY(struct listed) entries;
    ARRAY(struct mask_face) faces;
    bool failed;
};

struct build {
    struct mask_contour *map;
    const struct adjacency *adjacency;
    struct chunk *chunks;
    size_t chunk_count;
};

static bool out_of_memory(struct error *err)
{
    return error_set(err, ERROR_TRY_AGAIN, "size", "out of memory for a light's contour map");
}

static void mark(struct mask_contour *m, uint64_t *set, int64_t x, int64_t y)
{
    __atomic_fetch_or(&set[(size_t)y * m->words + (size_t)x / 64], UINT64_C(1) << (x % 64), __ATOMIC_RELAXED);
}

static double clamped(double v, double low, double high) { return v < low ? low : v > high ? high : v; }

/* All texels that a segment touches, row after row. */
static void mark_segment(struct mask_contour *m, double x0, double y0, double x1, double y1)
{
    double side = m->size, top = fmin(y0, y1) - EDGE_MARGIN, bottom = fmax(y0, y1) + EDGE_MARGIN;
    if (!(bottom >= 0 && top < side))
        return;
    int64_t from = (int64_t)clamped(floor(top), 0, side - 1), to = (int64_t)clamped(floor(bottom), 0, side - 1);
    double slope = y1 == y0 ? 0 : (x1 - x0) / (y1 - y0);
    for (int64_t y = from; y <= to; y++) {
        double a = y1 == y0 ? x0 : x0 + slope * (clamped((double)y - EDGE_MARGIN, fmin(y0, y1), fmax(y0, y1)) - y0);
        double b = y1 == y0 ? x1 : x0 + slope * (clamped((double)y + 1 + EDGE_MARGIN, fmin(y0, y1), fmax(y0, y1)) - y0);
        double left = floor(fmin(a, b) - EDGE_MARGIN), right = floor(fmax(a, b) + EDGE_MARGIN);
        if (!(right >= 0 && left < side))
            continue;
        for (int64_t x = (int64_t)fmax(left, 0); x <= (int64_t)fmin(right, side - 1); x++)
            mark(m, m->crossed, x, y);
    }
}

static void to_texels(const struct light_mesh *mesh, struct dvec3 p, double *x, double *y)
{
    double w = mesh->view.orthographic ? 1 : 1 / p.z;
    *x = p.x * w * mesh->scale_x + mesh->offset_x;
    *y = p.y * w * mesh->scale_y + mesh->offset_y;
}

/* An edge with an end behind the light's plane or far off the map: cut off where it can no longer be seen. */
static void mark_wild_edge(struct mask_contour *m, struct dvec3 a, struct dvec3 b)
{
    const struct light_mesh *mesh = &m->mesh;
    double x0, y0, x1, y1, least = mesh->view.near * 0x1p-10;
    if (!dvec3_finite(a) || !dvec3_finite(b))
        return;
    if (!mesh->view.orthographic) {
        if (a.z < least && b.z < least)
            return;
        if (a.z < least)
            a = dvec3_mad(a, dvec3_sub(b, a), (least - a.z) / (b.z - a.z));
        else if (b.z < least)
            b = dvec3_mad(b, dvec3_sub(a, b), (least - b.z) / (a.z - b.z));
    }
    to_texels(mesh, a, &x0, &y0);
    to_texels(mesh, b, &x1, &y1);
    mark_segment(m, x0, y0, x1, y1);
}

/* The sign of its projected area: 0 counts as a side of its own, so that all its edges are silhouettes. */
static int side_of(const struct light_mesh *mesh, const struct light_part *part, uint32_t id)
{
    struct light_triangle t = light_part_triangle(part, id);
    const struct light_vertex *a = t.corner[0], *b = t.corner[1], *c = t.corner[2];
    double area = light_triangle_wild(&t)
                      ? light_triangle_sides(mesh, part, id, 0, 0).area
                      : ((double)b->x - a->x) * ((double)c->y - a->y) - ((double)c->x - a->x) * ((double)b->y - a->y);
    return (area > 0) - (area < 0);
}

static void mark_edge(struct mask_contour *m, const struct light_part *part, uint32_t id, unsigned k)
{
    struct light_triangle t = light_part_triangle(part, id);
    const struct light_vertex *a = t.corner[k], *b = t.corner[k == 2 ? 0 : k + 1];
    if (isnan(a->x) || isnan(b->x))
        mark_wild_edge(m, light_part_corner(&m->mesh, part, id, k), light_part_corner(&m->mesh, part, id, k == 2 ? 0 : k + 1));
    else
        mark_segment(m, (double)a->x, (double)a->y, (double)b->x, (double)b->y);
}

static void mark_chunk(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct build *build = context;
    const struct chunk *chunk = &build->chunks[index];
    struct mask_contour *m = build->map;
    const struct scene *scene = m->mesh.scene;
    const struct mesh *mesh = &scene->meshes[scene->instances[chunk->part->instance].mesh];
    for (uint32_t t = chunk->first; t < chunk->end; t++) {
        const uint32_t *across = adjacency_of(build->adjacency, mesh, t);
        uint32_t id = chunk->part->first_triangle + t;
        int side = side_of(&m->mesh, chunk->part, id);
        for (unsigned k = 0; k < 3; k++)
            if (across[k] == SCENE_NONE ||
                (across[k] > t && (side == 0 || side_of(&m->mesh, chunk->part, chunk->part->first_triangle + across[k]) != side)))
                mark_edge(m, chunk->part, id, k);
    }
}

static void rank_crossed(struct mask_contour *m)
{
    size_t words = (size_t)m->words * m->size;
    m->crossed_count = 0;
    for (size_t i = 0; i < words; i++) {
        m->rank[i] = (uint32_t)m->crossed_count;
        m->crossed_count += (size_t)__builtin_popcountll(m->crossed[i]);
    }
}

/* Corners b and c change places where the face's back is to the light. */
static struct mask_face make_face(const struct light_mesh *mesh, const struct light_part *part, uint32_t id)
{
    struct dvec3 p[3];
    for (unsigned k = 0; k < 3; k++)
        p[k] = light_part_corner(mesh, part, id, k);
    struct dvec3 n = dvec3_cross(dvec3_sub(p[1], p[0]), dvec3_sub(p[2], p[0]));
    bool front = (mesh->view.orthographic ? n.z : dvec3_dot(n, p[0])) < 0;
    const unsigned order[4] = {0, front ? 1 : 2, front ? 2 : 1, 0};
    struct mask_face face = {.id = id};
    for (int k = 0; k < 4; k++) {
        face.x[k] = (float)p[order[k]].x;
        face.y[k] = (float)p[order[k]].y;
        face.z[k] = (float)p[order[k]].z;
    }
    return face;
}

static uint8_t in_texel(float v, uint32_t texel, bool up)
{
    float scaled = (v - (float)texel) * 255;
    return (uint8_t)fminf(fmaxf(up ? ceilf(scaled) : floorf(scaled), 0), 255);
}

/* The face in texel (x, y), which is crossed. `face`: its number in the chunk, or SCENE_NONE so far. */
static void list_face(const struct build *build, struct chunk *chunk, uint32_t id, uint32_t x, uint32_t y, const float box[4],
                      uint32_t *face)
{
    struct mask_contour *m = build->map;
    if (chunk->part->holes) {
        mark(m, m->holes, x, y);
        return;
    }
    if (*face == SCENE_NONE) {
        *face = (uint32_t)chunk->faces.count;
        chunk->failed |= !array_push(&chunk->faces, make_face(&m->mesh, chunk->part, id));
        if (chunk->failed)
            return;
    }
    const float *z = chunk->faces.data[*face].z;
    struct listed listed = {.texel = mask_contour_index(m, x, y),
                            .entry = {.face = *face,
                                      .left = in_texel(box[0], x, false),
                                      .top = in_texel(box[1], y, false),
                                      .right = in_texel(box[2], x, true),
                                      .bottom = in_texel(box[3], y, true),
                                      .nearest = fminf(fminf(z[0], z[1]), z[2])}};
    chunk->failed |= !array_push(&chunk->entries, listed);
}

static uint64_t crossed_between(const struct mask_contour *m, uint32_t y, uint32_t word, uint32_t x0, uint32_t x1)
{
    uint64_t bits = m->crossed[(size_t)y * m->words + word];
    if (word == x0 / 64)
        bits &= UINT64_MAX << (x0 % 64);
    if (word == x1 / 64)
        bits &= UINT64_MAX >> (63 - x1 % 64);
    return bits;
}

static void list_tame(const struct build *build, struct chunk *chunk, uint32_t id, const float x[3], const float y[3])
{
    const struct mask_contour *m = build->map;
    struct conservative c;
    uint32_t face = SCENE_NONE;
    if (!conservative_setup(&c, x, y, (int32_t)m->size, (int32_t)m->size))
        return;
    const float box[4] = {fminf(fminf(x[0], x[1]), x[2]), fminf(fminf(y[0], y[1]), y[2]), fmaxf(fmaxf(x[0], x[1]), x[2]),
                          fmaxf(fmaxf(y[0], y[1]), y[2])};
    uint32_t x0 = (uint32_t)c.x0, x1 = (uint32_t)c.x1;
    for (uint32_t row = (uint32_t)c.y0; row <= (uint32_t)c.y1; row++)
        for (uint32_t word = x0 / 64; word <= x1 / 64; word++)
            for (uint64_t bits = crossed_between(m, row, word, x0, x1); bits; bits &= bits - 1) {
                uint32_t column = word * 64 + (uint32_t)__builtin_ctzll(bits);
                bool touched = true;
                for (int k = 0; k < 3; k++)
                    touched &= CONSERVATIVE_EDGE(&c, k, (float)column, row) >= -c.reach[k];
                if (touched)
                    list_face(build, chunk, id, column, row, box, &face);
            }
}

/* A triangle that reaches behind the light's plane or far off the map touches every crossed texel of whose square its planes through the
 * light leave some: nothing certain is left out, some that it does not touch are listed. */
static void list_wild(const struct build *build, struct chunk *chunk, uint32_t id)
{
    const struct mask_contour *m = build->map;
    const float box[4] = {-INFINITY, -INFINITY, INFINITY, INFINITY};
    uint32_t face = SCENE_NONE;
    struct dvec3 c[3];
    for (unsigned k = 0; k < 3; k++)
        c[k] = light_part_corner(&m->mesh, chunk->part, id, k);
    if (light_corners_miss(&m->mesh, c, 0, 0, m->size, m->size) || light_part_degenerate(m->mesh.scene, chunk->part, id))
        return;
    for (uint32_t y = 0; y < m->size; y++)
        for (uint32_t word = 0; word < m->words; word++)
            for (uint64_t bits = m->crossed[(size_t)y * m->words + word]; bits; bits &= bits - 1) {
                uint32_t x = word * 64 + (uint32_t)__builtin_ctzll(bits);
                bool outside[3] = {true, true, true};
                for (unsigned corner = 0; corner < 4; corner++) {
                    struct light_sides s =
                        light_triangle_sides(&m->mesh, chunk->part, id, (float)(x + (corner & 1)), (float)(y + (corner >> 1)));
                    for (int k = 0; k < 3; k++)
                        outside[k] &= s.edge[k] < 0;
                }
                if (!outside[0] && !outside[1] && !outside[2])
                    list_face(build, chunk, id, x, y, box, &face);
            }
}

static void list_chunk(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct build *build = context;
    struct chunk *chunk = &build->chunks[index];
    for (uint32_t t = chunk->first; t < chunk->end && !chunk->failed; t++) {
        uint32_t id = chunk->part->first_triangle + t;
        struct light_triangle triangle = light_part_triangle(chunk->part, id);
        float x[3], y[3];
        for (int k = 0; k < 3; k++) {
            x[k] = triangle.corner[k]->x;
            y[k] = triangle.corner[k]->y;
        }
        if (light_triangle_wild(&triangle))
            list_wild(build, chunk, id);
        else
            list_tame(build, chunk, id, x, y);
    }
}

/* Chunks in order: lists ascend by id. */
static bool gather(struct build *build, size_t limit, struct error *err)
{
    struct mask_contour *m = build->map;
    bool failed = false;
    m->entry_count = m->face_count = 0;
    for (size_t i = 0; i < build->chunk_count; i++) {
        failed |= build->chunks[i].failed;
        m->entry_count += build->chunks[i].entries.count;
        m->face_count += build->chunks[i].faces.count;
    }
    m->bytes = (size_t)m->words * m->size * 20 + (m->crossed_count + 1) * 4 + m->entry_count * sizeof *m->entries +
               m->face_count * sizeof *m->faces + light_mesh_bytes(&m->mesh);
    if (limit && m->bytes > limit)
        return error_set(err, ERROR_TRY_AGAIN, "memory", "a contour map of %u x %u takes %zu MiB, and %zu are allowed", m->size,
                         m->size, m->bytes >> 20, limit >> 20);
    if (failed || m->entry_count >= UINT32_MAX)
        return out_of_memory(err);
    m->first = calloc(m->crossed_count + 2, sizeof *m->first);
    m->entries = malloc((m->entry_count + 1) * sizeof *m->entries);
    m->faces = malloc((m->face_count + 1) * sizeof *m->faces);
    if (!m->first || !m->entries || !m->faces)
        return out_of_memory(err);
    for (size_t i = 0; i < build->chunk_count; i++)
        for (size_t k = 0; k < build->chunks[i].entries.count; k++)
            m->first[build->chunks[i].entries.data[k].texel + 2]++;
    for (size_t i = 2; i < m->crossed_count + 2; i++)
        m->first[i] += m->first[i - 1];
    size_t faces = 0;
    for (size_t i = 0; i < build->chunk_count; i++) {
        const struct chunk *chunk = &build->chunks[i];
        for (size_t k = 0; k < chunk->entries.count; k++) {
            struct mask_entry entry = chunk->entries.data[k].entry;
            entry.face += (uint32_t)faces;
            m->entries[m->first[chunk->entries.data[k].texel + 1]++] = entry;
        }
        if (chunk->faces.count)
            memcpy(m->faces + faces, chunk->faces.data, chunk->faces.count * sizeof *m->faces);
        faces += chunk->faces.count;
    }
    return true;
}

static bool cut_into_chunks(struct build *build, struct error *err)
{
    const struct light_mesh *mesh = &build->map->mesh;
    size_t count = 0;
    for (size_t i = 0; i < mesh->part_count; i++)
        count += (mesh->parts[i].triangle_count + CHUNK - 1) / CHUNK;
    build->chunks = calloc(count + 1, sizeof *build->chunks);
    if (!build->chunks)
        return out_of_memory(err);
    for (size_t i = 0; i < mesh->part_count; i++)
        for (uint32_t first = 0, all = mesh->parts[i].triangle_count; first < all; first += CHUNK)
            build->chunks[build->chunk_count++] =
                (struct chunk){.part = &mesh->parts[i], .first = first, .end = all - first < CHUNK ? all : first + CHUNK};
    return true;
}

static void drop(struct mask_contour *m)
{
    free(m->crossed);
    free(m->holes);
    free(m->rank);
    free(m->first);
    free(m->entries);
    free(m->faces);
    m->crossed = m->holes = NULL;
    m->rank = m->first = NULL;
    m->entries = NULL;
    m->faces = NULL;
    m->crossed_count = m->entry_count = m->face_count = m->bytes = 0;
}

bool mask_contour_build(struct mask_contour *m, const struct scene *scene, const struct adjacency *adjacency,
                        const struct view *view, const uint32_t *casters, size_t caster_count, size_t limit,
                        struct job_pool *pool, struct error *err)
{
    struct build build = {m, adjacency, NULL, 0};
    drop(m);
    m->size = view->width;
    m->words = (view->width + 63) / 64;
    size_t words = (size_t)m->words * m->size;
    m->crossed = calloc(words, sizeof *m->crossed);
    m->holes = calloc(words, sizeof *m->holes);
    m->rank = malloc(words * sizeof *m->rank);
    bool ok = (m->crossed && m->holes && m->rank) || out_of_memory(err);
    ok = ok && light_mesh_project(&m->mesh, scene, view, casters, caster_count, pool, err) && cut_into_chunks(&build, err);
    if (ok) {
        job_pool_for(pool, build.chunk_count, mark_chunk, &build);
        rank_crossed(m);
        job_pool_for(pool, build.chunk_count, list_chunk, &build);
        ok = gather(&build, limit, err);
    }
    for (size_t i = 0; i < build.chunk_count; i++) {
        array_finish(&build.chunks[i].entries);
        array_finish(&build.chunks[i].faces);
    }
    free(build.chunks);
    return ok;
}

void mask_contour_finish(struct mask_contour *m)
{
    drop(m);
    light_mesh_finish(&m->mesh);
}
