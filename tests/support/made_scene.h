/* Small scenes by hand. Everything aborts when memory is out. */
#pragma once

#include "scene/scene.h"
#include "scene/view.h"

struct scene *made_scene(void);

/* Opaque grey; returns its index. */
uint32_t made_material(struct scene *scene, bool double_sided);

/* Triangles over `points`; returns the mesh's index. `uv` may be NULL. */
uint32_t made_mesh(struct scene *scene, const float (*points)[3], const float (*uv)[2], uint32_t point_count,
                   const uint32_t *indices, uint32_t index_count, uint32_t material);

void made_instance(struct scene *scene, uint32_t mesh, struct affine to_world);

/* A mesh of loose triangles, placed as it is. */
void made_triangles(struct scene *scene, const float (*points)[3], uint32_t point_count, uint32_t material);

/* Makes `material` a mask of `size` x `size` texels whose alpha is 255 where `solid[i]`, else 0. */
void made_mask(struct scene *scene, uint32_t material, uint32_t size, const uint8_t *solid);

/* scene_finish(), which must succeed. */
void made_finish(struct scene *scene);

struct camera made_camera(struct dvec3 eye, struct dvec3 target, double yfov);
struct light made_light(enum light_kind kind, struct dvec3 position, struct dvec3 towards);
