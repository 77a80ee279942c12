#include "scene/adjacency.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"

/* One mesh at work. */
struct weld {
    const float (*positions)[3];
    const uint32_t *indices;
    uint32_t vertex_count, index_count;
    uint32_t *same;          /* of each vertex: the first one at its position */
    uint32_t *table, slots;  /* of hashes, a power of two */
    uint32_t *start, *edges; /* edges, by their lower end: entries of `indices` where each begins */
};

static uint32_t hash_position(const float p[3])
{
    uint32_t h = 0;
    for (int k = 0; k < 3; k++) {
        float x = p[k] + 0.0f; /* -0 and 0 are one */
        uint32_t bits;
        memcpy(&bits, &x, sizeof bits);
        h = (h ^ bits) * 0x9e3779b1u;
        h ^= h >> 15;
    }
    return h;
}

static bool equal(const float a[3], const float b[3]) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

static void weld_vertices(struct weld *w)
{
    for (uint32_t i = 0; i < w->slots; i++)
        w->table[i] = SCENE_NONE;
    for (uint32_t v = 0; v < w->vertex_count; v++) {
        uint32_t slot = hash_position(w->positions[v]) & (w->slots - 1);
        while (w->table[slot] != SCENE_NONE && !equal(w->positions[w->table[slot]], w->positions[v]))
            slot = (slot + 1) & (w->slots - 1);
        if (w->table[slot] == SCENE_NONE)
            w->table[slot] = v;
        w->same[v] = w->table[slot];
    }
}

/* Ends of the edge that begins at entry i of the indices. */
static void ends(const struct weld *w, uint32_t i, uint32_t *low, uint32_t *high)
{
    uint32_t a = w->same[w->indices[i]], b = w->same[w->indices[i % 3 == 2 ? i - 2 : i + 1]];
    *low = a < b ? a : b;
    *high = a < b ? b : a;
}

static void sort_edges(struct weld *w)
{
    uint32_t low, high, sum = 0;
    memset(w->start, 0, ((size_t)w->vertex_count + 1) * sizeof *w->start);
    for (uint32_t i = 0; i < w->index_count; i++) {
        ends(w, i, &low, &high);
        w->start[low]++;
    }
    for (uint32_t v = 0; v <= w->vertex_count; v++) {
        uint32_t n = w->start[v];
        w->start[v] = sum;
        sum += n;
    }
    for (uint32_t i = 0; i < w->index_count; i++) {
        ends(w, i, &low, &high);
        w->edges[w->start[low]++] = i;
    }
    /* Starts have moved to the ends, which are the next ones' starts. */
    memmove(w->start + 1, w->start, (size_t)w->vertex_count * sizeof *w->start);
    w->start[0] = 0;
}

/* The one other edge with the same ends; SCENE_NONE: none, or several. */
static uint32_t partner(const struct weld *w, uint32_t i)
{
    uint32_t low, high, found = SCENE_NONE;
    ends(w, i, &low, &high);
    if (low == high)
        return SCENE_NONE;
    for (uint32_t e = w->start[low]; e < w->start[low + 1]; e++) {
        uint32_t other_low, other_high, other = w->edges[e];
        ends(w, other, &other_low, &other_high);
        if (other == i || other_high != high)
            continue;
        if (found != SCENE_NONE)
            return SCENE_NONE;
        found = other;
    }
    return found;
}

static bool link_mesh(const struct scene *scene, const struct mesh *mesh, uint32_t *across)
{
    struct weld w = {.positions = (const float(*)[3])scene->positions + mesh->first_vertex,
                     .indices = scene->indices + mesh->first_index,
                     .vertex_count = mesh->vertex_count,
                     .index_count = mesh->index_count / 3 * 3,
                     .slots = 16};
    while (w.slots < 0x80000000u && w.slots < 2 * (uint64_t)w.vertex_count)
        w.slots *= 2;
    w.same = malloc(((size_t)w.vertex_count + 1) * sizeof *w.same);
    w.table = malloc((size_t)w.slots * sizeof *w.table);
    w.start = malloc(((size_t)w.vertex_count + 1) * sizeof *w.start);
    w.edges = malloc(((size_t)w.index_count + 1) * sizeof *w.edges);
    bool ok = w.same && w.table && w.start && w.edges;
    if (ok) {
        weld_vertices(&w);
        sort_edges(&w);
        for (uint32_t i = 0; i < w.index_count; i++) {
            uint32_t other = partner(&w, i);
            across[i] = other == SCENE_NONE ? SCENE_NONE : other / 3;
        }
    }
    free(w.edges);
    free(w.start);
    free(w.table);
    free(w.same);
    return ok;
}

bool adjacency_init(struct adjacency *a, const struct scene *scene, struct error *err)
{
    *a = (struct adjacency){malloc((scene->index_count + 1) * sizeof *a->across), scene->index_count};
    bool ok = a->across != NULL;
    for (size_t m = 0; ok && m < scene->mesh_count; m++)
        ok = link_mesh(scene, &scene->meshes[m], a->across + scene->meshes[m].first_index);
    if (ok)
        return true;
    adjacency_finish(a);
    return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the edges of %zu triangles", scene->index_count / 3);
}

void adjacency_finish(struct adjacency *a)
{
    free(a->across);
    *a = (struct adjacency){0};
}
