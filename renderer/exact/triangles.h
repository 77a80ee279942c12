/* All drawn triangles in scene space, in double, one flat list: what docs/truth.md calls triangles, without those it ignores. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "exact/holes.h"
#include "scene/scene.h"

enum triangle_flags {
    TRIANGLE_HIDDEN_BACK = 1,     /* the camera does not see it where N . direction > 0 */
    TRIANGLE_HIDDEN_MIRRORED = 2, /* the same where N . direction < 0 */
    TRIANGLE_HOLES = 4,           /* its material has a mask */
    TRIANGLE_IGNORED = 8,         /* some corner is not finite or lies beyond FILTER_COORDINATE_MAX */
};

struct triangles {
    const struct scene *scene;
    uint32_t count; /* drawn triangles, by id */
    size_t vertex_count;
    struct dvec3 *vertices; /* of every instance; bit for bit what instance_vertex() gives */
    uint32_t (*corners)[3]; /* indices into vertices */
    uint8_t *flags;         /* enum triangle_flags */
    struct dbox bounds;     /* of all that are not ignored */
    struct hole_masks masks;
};

/* False when memory is out; triangles_finish() in any case. `scene` must outlive it. */
bool triangles_init(struct triangles *t, const struct scene *scene);
void triangles_finish(struct triangles *t);
size_t triangles_bytes(const struct scene *scene);

static inline void triangle_corners(const struct triangles *t, uint32_t id, struct dvec3 corners[3])
{
    for (int i = 0; i < 3; i++)
        corners[i] = t->vertices[t->corners[id][i]];
}
