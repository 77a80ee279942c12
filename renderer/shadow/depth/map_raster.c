#include "shadow/depth/map_raster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "shadow/depth/depth_pass.h"

enum { CHUNK = 4096 }; /* triangles a job */

/* Room for `count` of `size` bytes; what was there is lost when it grows. */
static bool reserve(void *array, size_t *room, size_t count, size_t size, struct error *err)
{
    void **data = array;
    if (*room >= count)
        return true;
    free(*data);
    *data = count <= SIZE_MAX / size ? malloc(count * size) : NULL;
    *room = *data ? count : 0;
    return *data || error_set(err, ERROR_TRY_AGAIN, "size", "out of memory for a map's triangles");
}

struct bin_job {
    struct map_raster *raster;
    size_t triangles;
    bool write; /* the second time: into entries */
    bool *wild; /* a chunk has some */
};

static inline float least_of(float a, float b, float c) { return a < b ? (a < c ? a : c) : (b < c ? b : c); }
static inline float most_of(float a, float b, float c) { return a > b ? (a > c ? a : c) : (b > c ? b : c); }

/* Of no area but for the rounding of its corners. Such triangles cast nothing. */
static bool is_degenerate(const struct map_raster *r, const struct light_part *part, uint32_t id, const struct light_triangle *t,
                          float extent)
{
    const struct light_vertex *const *c = t->corner;
    float area = (c[1]->x - c[0]->x) * (c[2]->y - c[0]->y) - (c[2]->x - c[0]->x) * (c[1]->y - c[0]->y);
    return fabsf(area) <= extent * (float)r->mesh.view.width * 0x1p-20f && light_part_degenerate(r->mesh.scene, part, id);
}

/* The bands that hold a texel centre within the triangle's height; left alone where no centre lies within its
 * box. Corners lie within a map's side of the map. */
static void find_bands(const struct map_raster *r, const struct light_part *part, uint32_t id, const struct light_triangle *t,
                       uint16_t range[2])
{
    const struct light_vertex *const *c = t->corner;
    int32_t side = (int32_t)r->mesh.view.width;
    float left = least_of(c[0]->x, c[1]->x, c[2]->x), right = most_of(c[0]->x, c[1]->x, c[2]->x);
    float top = least_of(c[0]->y, c[1]->y, c[2]->y), bottom = most_of(c[0]->y, c[1]->y, c[2]->y);
    if (right < 0.5f || bottom < 0.5f || left > (float)side - 0.5f || top > (float)side - 0.5f)
        return;
    int32_t x0 = (int32_t)(left + 0.5f), x1 = (int32_t)(right - 0.5f), y0 = (int32_t)(top + 0.5f), y1 = (int32_t)(bottom - 0.5f);
    y0 = y0 > 0 ? y0 : 0;
    y1 = y1 < side ? y1 : side - 1;
    if (x0 > x1 || y0 > y1 || is_degenerate(r, part, id, t, right - left + bottom - top))
        return;
    range[0] = (uint16_t)(y0 / RASTER_ROWS);
    range[1] = (uint16_t)(y1 / RASTER_ROWS + 1);
}

/* Of a wild triangle. */
static bool reaches_map(const struct map_raster *r, const struct light_part *part, uint32_t id)
{
    struct dvec3 c[3];
    if (light_part_degenerate(r->mesh.scene, part, id))
        return false;
    for (unsigned k = 0; k < 3; k++)
        c[k] = light_part_corner(&r->mesh, part, id, k);
    return !light_corners_miss(&r->mesh, c, 0, 0, r->mesh.view.width, r->mesh.view.height);
}

/* The part of triangle number `t`. */
static size_t find_part(const struct map_raster *r, size_t t)
{
    size_t low = 0, count = r->mesh.part_count;
    while (count > 1) {
        size_t half = count / 2;
        low += r->first[low + half] <= t ? half : 0;
        count -= half;
    }
    return low;
}

static void bin_chunk(void *context, size_t chunk, unsigned worker)
{
    (void)worker;
    const struct bin_job *job = context;
    struct map_raster *r = job->raster;
    uint32_t *counts = r->counts + chunk * r->bands;
    size_t t = chunk * CHUNK, end = t + CHUNK < job->triangles ? t + CHUNK : job->triangles;
    for (size_t p = find_part(r, t); t < end; p++) {
        const struct light_part *part = &r->mesh.parts[p];
        uint32_t first_vertex = (uint32_t)(part->vertices - r->mesh.vertices);
        for (; t < end && t < r->first[p + 1]; t++) {
            const uint32_t *index = part->indices + 3 * (t - r->first[p]);
            uint16_t *range = r->ranges + 2 * t;
            if (!job->write) {
                uint32_t id = part->first_triangle + (uint32_t)(t - r->first[p]);
                struct light_triangle corners = light_part_triangle(part, id);
                range[0] = range[1] = 0;
                if (light_triangle_wild(&corners))
                    job->wild[chunk] |= reaches_map(r, part, id);
                else
                    find_bands(r, part, id, &corners, range);
                for (unsigned b = range[0]; b < range[1]; b++)
                    counts[b]++;
                continue;
            }
            for (unsigned b = range[0]; b < range[1]; b++) {
                uint32_t *entry = r->entries + 3 * (size_t)counts[b]++;
                for (int k = 0; k < 3; k++)
                    entry[k] = first_vertex + index[k];
            }
        }
    }
}

/* From how many entries to where they begin; returns how many there are. */
static size_t sum_counts(struct map_raster *r)
{
    size_t sum = 0;
    for (uint32_t band = 0; band < r->bands; band++)
        for (uint32_t chunk = 0; chunk < r->chunks; chunk++) {
            uint32_t *count = &r->counts[(size_t)chunk * r->bands + band], own = *count;
            *count = (uint32_t)sum;
            sum += own;
        }
    return sum;
}

static bool count_triangles(struct map_raster *r, struct bin_job *job, struct error *err)
{
    const struct light_mesh *m = &r->mesh;
    if (!reserve(&r->first, &r->part_room, m->part_count + 1, sizeof *r->first, err))
        return false;
    job->triangles = 0;
    for (size_t p = 0; p < m->part_count; p++) {
        r->first[p] = job->triangles;
        job->triangles += m->parts[p].triangle_count;
    }
    r->first[m->part_count] = job->triangles;
    r->chunks = (uint32_t)((job->triangles + CHUNK - 1) / CHUNK);
    r->bands = (m->view.width + RASTER_ROWS - 1) / RASTER_ROWS;
    size_t counts = (size_t)r->chunks * r->bands;
    if (!reserve(&r->ranges, &r->triangle_room, 2 * job->triangles, sizeof *r->ranges, err) ||
        !reserve(&r->counts, &r->count_room, counts, sizeof *r->counts, err))
        return false;
    memset(r->counts, 0, counts * sizeof *r->counts);
    return true;
}

/* Lists each band's triangles. */
static bool bin(struct map_raster *r, struct job_pool *pool, bool *wild, struct error *err)
{
    struct bin_job job = {.raster = r};
    if (!count_triangles(r, &job, err))
        return false;
    job.wild = calloc(r->chunks + 1, sizeof *job.wild);
    if (!job.wild)
        return error_set(err, ERROR_TRY_AGAIN, "size", "out of memory for a map's triangles");
    job_pool_for(pool, r->chunks, bin_chunk, &job);
    for (uint32_t i = 0; i < r->chunks; i++)
        *wild |= job.wild[i];
    free(job.wild);
    if (*wild)
        return true;
    size_t entries = sum_counts(r);
    if (entries > UINT32_MAX / 3)
        return error_set(err, ERROR_TRY_AGAIN, "size", "a map of %u texels a side has too many triangles", r->mesh.view.width);
    if (!reserve(&r->entries, &r->entry_room, 3 * entries, sizeof *r->entries, err))
        return false;
    job.write = true;
    job_pool_for(pool, r->chunks, bin_chunk, &job);
    return true;
}

bool map_raster_draw(struct map_raster *r, const struct scene *scene, const struct view *view, const uint32_t *casters,
                     size_t caster_count, const struct depth_kernel *kernel, struct job_pool *pool, float *texels, bool *done,
                     struct error *err)
{
    bool holes = false;
    *done = false;
    for (size_t k = 0; k < caster_count; k++)
        holes |= material_has_holes(&scene->materials[scene->meshes[scene->instances[casters[k]].mesh].material]);
    if (holes)
        return true;
    if (!light_mesh_project(&r->mesh, scene, view, casters, caster_count, pool, err))
        return false;
    if (r->mesh.vertex_count > UINT32_MAX)
        return true;
    bool wild = false;
    if (!bin(r, pool, &wild, err))
        return false;
    if (wild)
        return true;
    struct raster_job job = {r, texels, view->width, (float)(view->orthographic ? 1 / (view->far - view->near) : view->near)};
    job_pool_for(pool, r->bands, kernel->rasterize, &job);
    *done = true;
    return true;
}

void map_raster_finish(struct map_raster *r)
{
    light_mesh_finish(&r->mesh);
    free(r->first);
    free(r->ranges);
    free(r->counts);
    free(r->entries);
    memset(r, 0, sizeof *r);
}

size_t map_raster_bytes(const struct map_raster *r)
{
    return light_mesh_bytes(&r->mesh) + r->part_room * sizeof *r->first + r->triangle_room * sizeof *r->ranges +
           r->count_room * sizeof *r->counts + r->entry_room * sizeof *r->entries;
}
