/* The steps of scene_finish(), inside scene/ only. */
#pragma once

#include "scene/scene.h"

struct error;

/* What bounds.c learns of a mesh and planar.c needs. */
struct mesh_shape {
    uint32_t largest_triangle; /* of all-finite corners and the largest area, the first of equals; SCENE_NONE: all have no area */
};

/* Reorders the triangles of dense meshes, and their vertices, along a curve through space: the same scene, of other ids. */
bool scene_order_triangles(struct scene *scene, struct error *err);

/* Fills bounds and planar of meshes, bounds of instances and of the scene. `shapes`: mesh_count entries. Instances are in scene space. */
bool scene_find_bounds(struct scene *scene, struct mesh_shape *shapes, struct error *err);

/* Fills others_side and the plane of instances. */
void scene_find_planes(struct scene *scene, const struct mesh_shape *shapes);

uint64_t scene_hash(const struct scene *scene);
