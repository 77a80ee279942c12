/* Builds a scene piece by piece. Failure (memory, more than 2^32 - 2 vertices) is remembered and told by mesh_builder_finish(),
 * so that scenes need no checks of their own.
 *
 * A mesh is made between mesh_builder_begin() and mesh_builder_end(), and placed once, as it stands. Vertex numbers count from
 * the mesh's first vertex. Faces are counter-clockwise seen from outside. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/array.h"
#include "scene/scene.h"

struct error;

struct builder_float3 {
    float v[3];
};

struct builder_float2 {
    float v[2];
};

struct builder_float4 {
    float v[4];
};

struct mesh_builder {
    bool failed;
    bool colored;   /* the mesh being made has vertex colours */
    bool textured;  /* the mesh being made has texture coordinates */
    float color[4]; /* of the vertices to come; linear */
    float texcoord[2];
    ARRAY(struct builder_float3) positions;
    ARRAY(struct builder_float3) normals;
    ARRAY(struct builder_float4) colors;
    ARRAY(struct builder_float2) texcoords;
    ARRAY(uint32_t) indices;
    ARRAY(struct mesh) meshes;
    ARRAY(struct instance) instances;
    ARRAY(struct material) materials;
    ARRAY(struct texture) textures;
    ARRAY(struct image) images;
    ARRAY(struct light) lights;
    ARRAY(struct camera) cameras;
};

/* A zeroed builder is ready for use. mesh_builder_finish() empties it, whatever it returns; NULL with `err` set on failure. */
struct scene *mesh_builder_finish(struct mesh_builder *b, const char *name, struct error *err);

/* The index of a new dielectric material. `rgb` linear, [0,1]. */
uint32_t mesh_builder_material(struct mesh_builder *b, const char *name, const float rgb[3], float roughness, bool double_sided);

/* Gives `material` a base colour texture, nearest texel, clamped, alpha MASK with cutoff 0.5. `rgba`: malloc'd, side x side x 4, becomes
 * the builder's; NULL: memory ran out. */
void mesh_builder_cut_out(struct mesh_builder *b, uint32_t material, uint32_t side, uint8_t *rgba);

void mesh_builder_begin(struct mesh_builder *b, const char *name, uint32_t material);
/* The same, with vertex colours that multiply the material's: set by mesh_builder_color(), white at first. */
void mesh_builder_begin_colored(struct mesh_builder *b, const char *name, uint32_t material);
void mesh_builder_color(struct mesh_builder *b, double red, double green, double blue);
/* With texture coordinates, set by mesh_builder_texcoord() before each vertex. */
void mesh_builder_begin_textured(struct mesh_builder *b, const char *name, uint32_t material);
void mesh_builder_texcoord(struct mesh_builder *b, double u, double v);
/* Vertices and triangles of the mesh being made. */
uint32_t mesh_builder_vertices(const struct mesh_builder *b);
uint32_t mesh_builder_triangles(const struct mesh_builder *b);
void mesh_builder_end(struct mesh_builder *b);

/* `normal` unit. The new vertex's number. */
uint32_t mesh_builder_vertex(struct mesh_builder *b, struct dvec3 position, struct dvec3 normal);
void mesh_builder_triangle(struct mesh_builder *b, uint32_t i, uint32_t j, uint32_t k);
/* Triangles i j k and i k l. */
void mesh_builder_quad(struct mesh_builder *b, uint32_t i, uint32_t j, uint32_t k, uint32_t l);

/* With vertices of their own and the face's normal. */
void mesh_builder_flat_triangle(struct mesh_builder *b, struct dvec3 p, struct dvec3 q, struct dvec3 r);
void mesh_builder_flat_quad(struct mesh_builder *b, struct dvec3 p, struct dvec3 q, struct dvec3 r, struct dvec3 s);

/* `center` of the bottom face, `size` along x, y, z, turned by `turn` radians about the vertical. 12 triangles. */
void mesh_builder_box(struct mesh_builder *b, struct dvec3 center, struct dvec3 size, double turn);

/* A round tube along `count` >= 2 distinct points, 2 * sides * (count - 1) triangles, smooth, open at both ends. `capped` closes
 * it with 2 * sides more that share its vertices. */
void mesh_builder_tube(struct mesh_builder *b, const struct dvec3 *points, const double *radii, unsigned count, unsigned sides,
                       bool capped);

/* An ellipsoid with half axes `radii`, closed, 2 * sides * (rings - 1) triangles; rings >= 2. `axes`: its x, y (poles) and z,
 * right-handed. */
void mesh_builder_ellipsoid(struct mesh_builder *b, struct dvec3 center, const struct dvec3 axes[3], const double radii[3],
                            unsigned rings, unsigned sides);

/* Replaces the normals of the mesh being made from vertex `first` on: the area-weighted mean of the triangles at each vertex. */
void mesh_builder_smooth(struct mesh_builder *b, uint32_t first);

/* Moves the mesh being made so that its lowest vertex is at y = 0. */
void mesh_builder_stand(struct mesh_builder *b);

/* Everything placed so far: instances, lights and cameras, moved, then scaled about the world's origin. In doubles: vertices keep their bits.
 * Scaling keeps what is seen as bright as it was. */
void mesh_builder_move(struct mesh_builder *b, struct dvec3 by);
void mesh_builder_scale(struct mesh_builder *b, double factor);

/* A mesh of its own: `width` x `depth` about the origin at y = 0, two triangles. */
void mesh_builder_ground(struct mesh_builder *b, double width, double depth, const float rgb[3]);

void mesh_builder_point_light(struct mesh_builder *b, struct dvec3 position, float intensity);
/* `direction` is stored as given: unit, the way the light travels. */
void mesh_builder_directional_light(struct mesh_builder *b, struct dvec3 direction, float intensity);
/* Half angles in radians; `direction` as above. */
void mesh_builder_spot_light(struct mesh_builder *b, struct dvec3 position, struct dvec3 direction, double inner, double outer,
                             float intensity);
void mesh_builder_camera(struct mesh_builder *b, struct dvec3 eye, struct dvec3 target, double yfov);
/* Names the camera made last; without, it is "camera". */
void mesh_builder_name_camera(struct mesh_builder *b, const char *name);
/* Looks straight down from `height`, picture right = +x, picture up = -z, 2 * half_height high. */
void mesh_builder_camera_above(struct mesh_builder *b, double height, double half_height);

/* The ground, light and camera that the large models share: 12 x 12, a point light of 400 cd at (2.5, 5, 3), an eye at (0, 2.2,
 * 4.8). */
void mesh_builder_stage(struct mesh_builder *b);

/* A fixed integer hash, and the same as a number in [0, 1). */
uint32_t hash_uint32(uint32_t x);
double hash_unit(uint32_t x);
