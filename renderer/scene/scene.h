/* A scene as plain data: indices, not pointers. Made by scene_load(), import/ or builtin/, then frozen by scene_finish(); read-only
 * from then on and free to share between threads.
 *
 * Spaces. "World" is what files, options and messages speak: doubles. "Scene space" is world minus scene.origin, and everything in
 * a finished scene is in scene space: the origin is taken from the first instance, so a scene moved as a whole (nodes, cameras and
 * lights) by an exactly representable vector is bit for bit the same scene, however far out it lies.
 * Right-handed, Y up, angles in radians, lengths in scene units.
 *
 * The true position of a vertex is affine_point(&instance.to_scene, fp32 position) in double: one expression, evaluated by
 * instance_vertex() alone, so that everybody who asks gets the same bits. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/dmath.h"

#define SCENE_NONE UINT32_MAX

struct error;

enum alpha_mode { ALPHA_OPAQUE, ALPHA_MASK, ALPHA_BLEND };
enum wrap_mode { WRAP_REPEAT, WRAP_MIRRORED_REPEAT, WRAP_CLAMP_TO_EDGE };

/* Pixels as decoded: 8-bit RGBA, rows top to bottom, straight alpha. Whether RGB is sRGB or linear is said by its use. */
struct image {
    uint32_t width, height; /* 1..16384 */
    uint8_t *rgba;          /* width * height * 4, owned */
    char name[64];
};

struct texture {
    uint32_t image;
    enum wrap_mode wrap_s, wrap_t;
    bool nearest; /* magnification filter */
};

/* A material's use of a texture. */
struct texture_use {
    uint32_t texture;      /* SCENE_NONE: not textured */
    uint32_t texcoord;     /* 0 or 1 */
    float transform[2][3]; /* KHR_texture_transform, rows: uv' = transform * (u, v, 1); identity if absent */
};

/* glTF metallic-roughness. */
struct material {
    char name[64];
    float base_color[4]; /* linear, [0,1] */
    float metallic;      /* [0,1] */
    float roughness;     /* [0,1] */
    float emissive[3];   /* linear, >= 0 */
    float normal_scale;
    float occlusion_strength; /* [0,1] */
    enum alpha_mode alpha_mode;
    float alpha_cutoff; /* BLEND: 0.5, since it counts as MASK in the id buffer and as a caster */
    bool double_sided;  /* false: back faces are hidden from the camera only; every triangle casts */
    bool unlit;
    struct texture_use base_color_texture, metallic_roughness_texture, normal_texture, occlusion_texture, emissive_texture;
};

/* One glTF primitive: an indexed triangle list. Ranges into the scene's arrays. */
struct mesh {
    char name[64];
    uint32_t first_vertex, vertex_count;
    uint32_t first_index, index_count; /* index_count = 3 * triangles; indices count from first_vertex */
    uint32_t first_texcoord[2];        /* into scene.texcoords; SCENE_NONE: has none; else vertex_count entries */
    uint32_t first_color;              /* into scene.colors; SCENE_NONE: has none; else vertex_count entries */
    uint32_t material;                 /* always valid */

    /* Set by scene_finish(). */
    float bounds_min[3], bounds_max[3]; /* over finite vertices that a triangle uses; min > max when there is none */
    bool planar;                        /* all its triangles lie in one plane, to 1e-6 of its extent */
};

/* A mesh placed in the scene; every drawn triangle belongs to exactly one. */
struct instance {
    uint32_t mesh;
    struct affine to_scene; /* before scene_finish(): to world */

    /* Set by scene_finish(). */
    uint32_t first_triangle; /* drawn-triangle id of its triangle 0; ids run on over the instances in order */
    bool mirrored;           /* determinant < 0: front faces are clockwise */
    struct dbox bounds;      /* scene space; empty when nothing finite */
    /* A planar instance casts no shadow from a light that has everything else on its own side.
     * +1: all other geometry lies on the side the plane's normal (cross product of its first non-degenerate triangle's
     * edges, scene space) points to, -1: on the other side, 2: nothing else on either side, 0: not planar or on both sides. */
    int8_t others_side;
    struct dvec3 plane_normal; /* unit; valid if others_side != 0 */
    struct dvec3 plane_point;
};

enum light_kind { LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPOT };

/* KHR_lights_punctual, in doubles. */
struct light {
    char name[64];
    enum light_kind kind;
    struct dvec3 position;  /* point, spot */
    struct dvec3 direction; /* unit; the way the light travels; spot, directional */
    float color[3];         /* linear, >= 0 */
    float intensity;        /* candela (point, spot) or lux (directional), >= 0 */
    double radius;          /* of the emitting disc, for area references; 0: not given */
    double inner, outer;    /* spot: half angles, 0 <= inner < outer <= pi/2 */
    double range;           /* point, spot: nothing is lit beyond; 0: no limit */
};

/* Where a picture is taken from. Axes are unit and orthogonal; the camera looks along -back. */
struct camera {
    char name[64];
    bool orthographic;
    struct dvec3 eye, right, up, back;
    double yfov; /* perspective: full vertical angle, (0, pi) */
    double ymag; /* orthographic: half the height, > 0 */
    double near; /* along -back, > 0 (perspective) or >= 0 (orthographic); nothing nearer is seen */
    double far;  /* > near; INFINITY: no limit */
};

struct scene {
    char name[128];
    struct dvec3 origin; /* world position of scene space's (0, 0, 0) */

    float (*positions)[3];
    float (*normals)[3]; /* unit; made from faces where the file has none */
    size_t vertex_count;
    uint32_t *indices;
    size_t index_count;
    float (*texcoords)[2];
    size_t texcoord_count;
    float (*colors)[4]; /* linear */
    size_t color_count;

    struct mesh *meshes;
    size_t mesh_count;
    struct instance *instances;
    size_t instance_count;
    struct material *materials;
    size_t material_count;
    struct texture *textures;
    size_t texture_count;
    struct image *images;
    size_t image_count;
    struct light *lights; /* as the file has them: may be none, see scene_default_light() */
    size_t light_count;
    struct camera *cameras; /* as the file has them: may be none, see scene_default_camera() */
    size_t camera_count;

    /* Set by scene_finish(). */
    size_t triangle_count;       /* stored, over all meshes */
    size_t drawn_triangle_count; /* over all instances; < 2^32 - 1 */
    struct dbox bounds;          /* of all instances, scene space */
    uint64_t hash;               /* of everything that a picture depends on */
};

/* Loads a .gltf/.glb path or `builtin:NAME[:key=value,...]`. Errors: ERROR_NO_INPUT (no such file or
 * built-in), ERROR_DATA, ERROR_USAGE (a built-in's parameters). The caller frees with scene_destroy(). */
struct scene *scene_load(const char *name, struct error *err);

/* Accepts NULL and half-made scenes (every array is malloc'd or NULL). */
void scene_destroy(struct scene *scene);

/* Computes what is marked above, reorders the triangles and vertices of dense meshes (scene/order.c), moves instances, cameras and lights from world into scene space. To be called once, by whoever fills a
 * scene. Refuses (ERROR_DATA) 2^32 - 1 or more drawn triangles. */
bool scene_finish(struct scene *scene, struct error *err);

/* The light and the camera a scene gets when it has none: one directional light; a camera that frames the bounds. Scene space. */
struct light scene_default_light(const struct scene *scene);
struct camera scene_default_camera(const struct scene *scene, double aspect);

/* True vertex `corner` (0..2) of `triangle` (0-based in the mesh), scene space. */
struct dvec3 instance_vertex(const struct scene *scene, const struct instance *instance, uint32_t triangle, unsigned corner);

/* The instance that drawn-triangle `id` belongs to; id < drawn_triangle_count. */
uint32_t scene_instance_of(const struct scene *scene, uint32_t id);

/* Alpha of `material` at texture coordinates `uv` (already transformed by nobody: raw TEXCOORD): base_color[3] times the base level's
 * nearest texel times `vertex_alpha`. The one rule for holes, in camera visibility and in shadows, in every system. */
float material_alpha(const struct scene *scene, const struct material *material, const float uv[2], float vertex_alpha);

/* Its last step, for a texture's alpha of 0 to 255. */
static inline float material_texel_alpha(const struct material *m, float vertex_alpha, uint8_t texel)
{
    return m->base_color[3] * vertex_alpha * ((float)texel / 255.0f);
}

/* The texel in [0, size) that stands for any. */
uint32_t texture_wrap(int64_t texel, uint32_t size, enum wrap_mode wrap);

/* True when a triangle of this material may have holes (MASK or BLEND). */
static inline bool material_has_holes(const struct material *m) { return m->alpha_mode != ALPHA_OPAQUE; }
