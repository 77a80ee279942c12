/* The contour map: which texels of a light's map a silhouette edge crosses, and of those every face that touches them.
 *
 * An edge is a silhouette's if its two faces turn different sides to the light, or if it has one face, or more than two. A texel that no
 * such edge crosses holds whole sheets: its depth tells what lies in it. Built on the job pool, in an order that no thread decides. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/adjacency.h"
#include "shadow/geometry/light_mesh.h"

/* A face: its corners along the map's axes, relative to the map's eye, a member at a time; turned so that its front faces the light. The fourth is
 * the first again: four lanes for three edges and the plane. */
struct mask_face {
    float x[4], y[4], z[4];
    uint32_t id; /* drawn */
};

/* A face in a crossed texel. Its projection's box within the texel, in 1/255 texel, rounded outward; and its least depth along the axis. */
struct mask_entry {
    uint32_t face;
    uint8_t left, top, right, bottom;
    float nearest;
};

struct mask_contour {
    struct light_mesh mesh;
    uint32_t size, words; /* texels a side; words of 64 texels a row */
    uint64_t *crossed;    /* a bit a texel */
    uint64_t *holes;      /* of the crossed: a face with holes touches it */
    uint32_t *rank;       /* of each word: crossed texels before it */
    uint32_t *first;      /* of each crossed texel, and the end: into entries */
    struct mask_entry *entries;
    struct mask_face *faces;
    size_t crossed_count, entry_count, face_count, bytes;
};

/* Builds it anew. ERROR_TRY_AGAIN when memory is out or more than `limit` bytes (0: no limit) were needed. */
bool mask_contour_build(struct mask_contour *m, const struct scene *scene, const struct adjacency *adjacency,
                        const struct view *view, const uint32_t *casters, size_t caster_count, size_t limit,
                        struct job_pool *pool, struct error *err);
void mask_contour_finish(struct mask_contour *m);

static inline bool mask_contour_at(const struct mask_contour *m, uint32_t x, uint32_t y)
{
    return m->crossed[(size_t)y * m->words + x / 64] >> (x % 64) & 1;
}

static inline bool mask_contour_has_holes(const struct mask_contour *m, uint32_t x, uint32_t y)
{
    return m->holes[(size_t)y * m->words + x / 64] >> (x % 64) & 1;
}

/* Which list a crossed texel has: first[index] to first[index + 1]. */
static inline uint32_t mask_contour_index(const struct mask_contour *m, uint32_t x, uint32_t y)
{
    size_t word = (size_t)y * m->words + x / 64;
    return m->rank[word] + (uint32_t)__builtin_popcountll(m->crossed[word] & ((UINT64_C(1) << (x % 64)) - 1));
}
