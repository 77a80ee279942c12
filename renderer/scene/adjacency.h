/* Which triangles of a mesh share edges: by position, since files repeat vertices where normals or texture coordinates differ. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"

struct error;

struct adjacency {
    /* [3 * (mesh.first_index / 3 + t) + k]: the triangle (0-based in the mesh) beyond the edge from corner k to corner k + 1 of triangle t;
     * SCENE_NONE where there is none, or more than one. */
    uint32_t *across;
    size_t count; /* entries */
};

/* Of every mesh of a finished scene. ERROR_TRY_AGAIN when memory is out. */
bool adjacency_init(struct adjacency *a, const struct scene *scene, struct error *err);
void adjacency_finish(struct adjacency *a);

static inline const uint32_t *adjacency_of(const struct adjacency *a, const struct mesh *mesh, uint32_t triangle)
{
    return a->across + mesh->first_index + 3 * (size_t)triangle;
}
