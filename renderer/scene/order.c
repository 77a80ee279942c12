/* Triangles and vertices of dense meshes, put in an order that follows space: what lies near in the scene, and so in a picture or on a map,
 * lies near in memory. Files order them by the tool that made them; on a scanned dragon a triangle's corners lie megabytes apart, and everything
 * that goes from a triangle's id to its corners waits for memory.
 *
 * Morton 1966, "A computer oriented geodetic data base": centroids along the Z curve of a grid of 1024 a side, cubes over the mesh's box. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "scene/finish.h"

enum { DENSE = 32768 }; /* triangles: fewer, with their corners and neighbours, fit a core's cache in any order */

struct keyed {
    uint32_t key, triangle;
};

struct ordering {
    struct scene *scene;
    const struct mesh *mesh;
    uint32_t count;
    struct keyed *keys, *other;
    uint32_t *place; /* of each vertex, old to new */
    unsigned char *moved;
};

static uint32_t spread(uint32_t v)
{
    v = (v | v << 16) & 0x030000ff;
    v = (v | v << 8) & 0x0300f00f;
    v = (v | v << 4) & 0x030c30c3;
    return (v | v << 2) & 0x09249249;
}

static uint32_t cell(float value, float low, float extent)
{
    float at = (value - low) / extent * 1024;
    return at >= 0 ? at < 1023 ? (uint32_t)at : 1023 : 0; /* not numbers too: 0 */
}

static void find_box(const float (*positions)[3], const uint32_t *indices, uint32_t count, float low[3], float high[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
    }
    for (uint32_t i = 0; i < 3 * count; i++)
        for (int k = 0; k < 3; k++) {
            float v = positions[indices[i]][k];
            low[k] = v < low[k] ? v : low[k];
            high[k] = v > high[k] ? v : high[k];
        }
}

static void make_keys(struct ordering *o)
{
    const float(*p)[3] = (const float(*)[3])o->scene->positions + o->mesh->first_vertex;
    const uint32_t *index = o->scene->indices + o->mesh->first_index;
    float low[3], high[3], extent = 0;
    find_box(p, index, o->count, low, high);
    for (int k = 0; k < 3; k++)
        extent = high[k] - low[k] > extent ? high[k] - low[k] : extent;
    for (uint32_t t = 0; t < o->count; t++, index += 3) {
        uint32_t key = 0;
        for (int k = 0; k < 3; k++)
            key |= spread(cell((p[index[0]][k] + p[index[1]][k] + p[index[2]][k]) / 3, low[k], extent)) << k;
        o->keys[t] = (struct keyed){key, t};
    }
}

/* By key, of equal ones as they were. */
static void sort_keys(struct ordering *o)
{
    for (unsigned shift = 0; shift < 30; shift += 10) {
        uint32_t start[1024] = {0}, sum = 0;
        for (uint32_t i = 0; i < o->count; i++)
            start[o->keys[i].key >> shift & 1023]++;
        for (int k = 0; k < 1024; k++) {
            uint32_t n = start[k];
            start[k] = sum;
            sum += n;
        }
        for (uint32_t i = 0; i < o->count; i++)
            o->other[start[o->keys[i].key >> shift & 1023]++] = o->keys[i];
        struct keyed *swap = o->keys;
        o->keys = o->other;
        o->other = swap;
    }
}

static void move_triangles(struct ordering *o)
{
    uint32_t *index = o->scene->indices + o->mesh->first_index, *moved = (uint32_t *)(void *)o->moved;
    for (uint32_t i = 0; i < o->count; i++)
        memcpy(moved + 3 * (size_t)i, index + 3 * (size_t)o->keys[i].triangle, 3 * sizeof *index);
    memcpy(index, moved, 3 * (size_t)o->count * sizeof *index);
}

/* An attribute's `size` bytes a vertex. */
static void move_attribute(struct ordering *o, void *first, size_t size)
{
    for (uint32_t v = 0; v < o->mesh->vertex_count; v++)
        memcpy(o->moved + o->place[v] * size, (unsigned char *)first + v * size, size);
    memcpy(first, o->moved, o->mesh->vertex_count * size);
}

/* In the order of first use; unused ones last, as they were. */
static void move_vertices(struct ordering *o)
{
    struct scene *s = o->scene;
    const struct mesh *m = o->mesh;
    uint32_t *index = s->indices + m->first_index, next = 0;
    memset(o->place, 0xff, m->vertex_count * sizeof *o->place);
    for (uint32_t i = 0; i < 3 * o->count; i++) {
        uint32_t *place = &o->place[index[i]];
        if (*place == SCENE_NONE)
            *place = next++;
        index[i] = *place;
    }
    for (uint32_t v = 0; v < m->vertex_count; v++)
        if (o->place[v] == SCENE_NONE)
            o->place[v] = next++;
    move_attribute(o, s->positions + m->first_vertex, sizeof *s->positions);
    move_attribute(o, s->normals + m->first_vertex, sizeof *s->normals);
    for (int k = 0; k < 2; k++)
        if (m->first_texcoord[k] != SCENE_NONE)
            move_attribute(o, s->texcoords + m->first_texcoord[k], sizeof *s->texcoords);
    if (m->first_color != SCENE_NONE)
        move_attribute(o, s->colors + m->first_color, sizeof *s->colors);
}

/* Primitives of one file may draw from the same vertices. */
static bool shares_vertices(const struct scene *scene, const struct mesh *mesh)
{
    for (size_t m = 0; m < scene->mesh_count; m++) {
        const struct mesh *other = &scene->meshes[m];
        if (other != mesh && other->first_vertex < mesh->first_vertex + mesh->vertex_count &&
            mesh->first_vertex < other->first_vertex + other->vertex_count)
            return true;
    }
    return false;
}

static bool order_mesh(struct scene *scene, const struct mesh *mesh)
{
    struct ordering o = {.scene = scene, .mesh = mesh, .count = mesh->index_count / 3};
    size_t triangle_bytes = 3 * (size_t)o.count * sizeof(uint32_t), vertex_bytes = mesh->vertex_count * sizeof *scene->colors;
    struct keyed *first = malloc(o.count * sizeof *first), *second = malloc(o.count * sizeof *second);
    o.keys = first;
    o.other = second;
    o.place = malloc(mesh->vertex_count * sizeof *o.place);
    o.moved = malloc(triangle_bytes > vertex_bytes ? triangle_bytes : vertex_bytes);
    bool ok = o.keys && o.other && o.place && o.moved;
    if (ok) {
        make_keys(&o);
        sort_keys(&o);
        move_triangles(&o);
        if (!shares_vertices(scene, mesh))
            move_vertices(&o);
    }
    free(o.moved);
    free(o.place);
    free(second);
    free(first);
    return ok;
}

bool scene_order_triangles(struct scene *scene, struct error *err)
{
    for (size_t m = 0; m < scene->mesh_count; m++)
        if (scene->meshes[m].index_count / 3 >= DENSE && !order_mesh(scene, &scene->meshes[m]))
            return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for ordering %u triangles",
                             scene->meshes[m].index_count / 3);
    return true;
}
