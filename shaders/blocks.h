/* Bindings and uniform blocks, compiled by C and by GLSL: the one place where the two sides agree.
 *
 * "Relative" = scene space minus the eye of the view at hand, subtracted in double on the CPU; so single precision serves however
 * far out the scene lies. Pictures have row 0 at the top. */
#ifndef BLOCKS_H
#define BLOCKS_H

#ifdef GL_core_profile
#define BLOCK(name, slot) layout(std140, binding = slot) uniform name
#else
#include <cglm/cglm.h>
#include <stdint.h>
typedef uint32_t uvec4[4];
#define BLOCK(name, slot) struct name
#endif

/* Texture units. */
#define UNIT_VERTICES    0  /* RGBA32UI: position (float bits), normal (two snorm16, octahedral) */
#define UNIT_TRIANGLES   1  /* RGBA32UI: three vertex indices, unused */
#define UNIT_INSTANCES   2  /* RGBA32UI: first drawn triangle, first row of UNIT_TRIANGLES, material, INSTANCE_ flags */
#define UNIT_ROWS        3  /* RGBA32F, 3 an instance: rows of relative-from-mesh */
#define UNIT_TEXCOORDS   4  /* RGBA32F a vertex: sets 0 and 1 */
#define UNIT_COLORS      5  /* RGBA32F a vertex */
#define UNIT_MATERIALS   6  /* RGBA32F, MATERIAL_TEXELS each */
#define UNIT_TEXTURES    7  /* RGBA32UI: first texel, width | height << 16, wrap_s | wrap_t << 8 | nearest << 16, levels */
#define UNIT_TEXELS      8  /* R32UI: RGBA8, level after level */
#define UNIT_IDS         9  /* R32UI: drawn triangle id, NO_TRIANGLE: background */
#define UNIT_PIXELS      10 /* RGBA32UI: struct pixel (pixel.glsl) */
#define UNIT_VISIBILITY  11 /* R32F array, a layer a light */
#define UNIT_SHADOW_MAP  12 /* D32F array, a layer a map */
#define UNIT_EMISSION    14 /* RGBA16F: emitted radiance, occlusion (-1: unlit) */
#define UNIT_PICTURE     13 /* struct lighting's samples */
#define UNIT_MAP_RANGES  15 /* RG32F array: shadow/depth/map_ranges.h */
#define UNIT_SOFT_TERM   16 /* R32UI: soft_term.glsl */
#define UNIT_SOFT_RADIUS 17 /* R32UI: soft_term.glsl */

#define UNIT_ASM_IDS   22 /* R32UI: drawn triangle seen in a texel of a page */
#define UNIT_ASM_TABLE 23 /* R32UI: child of each cell of each slot, 0: none */

#define NO_TRIANGLE       0xffffffffu
#define INSTANCE_MIRRORED 1u

/* Adaptive shadow maps (shadow/asm/). A page is ASM_PAGE texels a side and has ASM_CELLS cells a side, each of which a page of its own may refine
 * ASM_CELLS times; so often below the root at most; slots a row of the pool's textures; figures behind the counters of slots. */
#define ASM_PAGE    16
#define ASM_CELLS   4
#define ASM_LEVELS  8
#define ASM_COLUMNS 64

#define LIGHTS_MAX 16
#define MAPS_MAX   6

/* A material: base colour; metallic (-1: unlit), roughness, normal scale, occlusion strength; emissive, alpha cutoff (-1: no holes); then
 * for each texture use (MATERIAL_BASE_COLOR ...): index (-1: none), set, transform[0][2], transform[1][2]; transform[0..1][0..1]. */
#define MATERIAL_TEXELS             13
#define MATERIAL_BASE_COLOR         3
#define MATERIAL_METALLIC_ROUGHNESS 5
#define MATERIAL_NORMAL             7
#define MATERIAL_OCCLUSION          9
#define MATERIAL_EMISSIVE           11

#define LIGHT_KIND_DIRECTIONAL 0
#define LIGHT_KIND_POINT       1
#define LIGHT_KIND_SPOT        2

/* The camera: the ray through the centre of pixel (x, y) is origin + t * direction, both affine in x and y; t is the depth. */
BLOCK(view_block, 0)
{
    vec4 ray_origin, ray_origin_dx, ray_origin_dy; /* xyz, relative; zero in perspective */
    vec4 ray_direction, ray_direction_dx, ray_direction_dy;
    vec4 view_forward; /* w: size of a pixel at depth 1 (perspective) or anywhere (orthographic) */
    vec4 view_clip;    /* near, far (0: none), 1 if orthographic, unused */
    uvec4 view_counts; /* instances, steps of a search among them, unused */
};

/* What the rasterizer draws from: a camera's or a light map's view. */
BLOCK(draw_block, 1)
{
    mat4 clip_from_relative;
    vec4 draw_far; /* x: depth beyond which nothing is drawn, 0: no limit; yzw: view axis */
};

/* The light being resolved. */
BLOCK(light_block, 2)
{
    vec4 light_position;  /* relative; w: LIGHT_KIND_ */
    vec4 light_direction; /* the way it travels, unit; w: range, 0: none */
    vec4 light_cone;      /* cosine of the outer angle; unused */
};

/* Its maps. Map coordinates of relative point p: q = (dot(row[0], p1), dot(row[1], p1), dot(row[2], p1)), p1 = (p, 1); texel = q.xy / w *
 * scale.xy + scale.zw with w = q.z (perspective) or 1; q.z is the depth along the map's axis. */
BLOCK(maps_block, 3)
{
    vec4 map_rows[3 * MAPS_MAX];
    vec4 map_scale[MAPS_MAX];
    vec4 map_depth[MAPS_MAX]; /* near, far, unused, world size of a texel (at depth 1 if perspective) */
    uvec4 map_counts;         /* maps, side in texels, unused, unused */
};

/* The trees of an adaptive shadow map. Its finest texels, ASM_CELLS^ASM_LEVELS to one of the root, number all places: place = base + floor(part + q.xy /
 * w) with q and w as in maps_block, so that what is far from the map's corner and near the camera keeps its precision. */
BLOCK(asm_block, 7)
{
    vec4 asm_rows[3 * MAPS_MAX]; /* the first two in finest texels, seen from the base */
    vec4 asm_part[MAPS_MAX];     /* xy: the base's fraction; z: near; w: far (0: none) */
    ivec4 asm_base[MAPS_MAX];    /* xy: the base; zw: column and row of the root's first slot */
    vec4 asm_texel;   /* x: world size of a root texel (at depth 1 if perspective), largest of the maps; y: of its smaller side */
    ivec4 asm_counts; /* side in finest texels, slots, pixels to each one analysed, which of them now */
};

/* The parameters of the shadow system at work, in the order of its descriptors. */
BLOCK(params_block, 4) { vec4 params[4]; };

/* All lights, for shading. */
BLOCK(lights_block, 5)
{
    vec4 lights_position[LIGHTS_MAX];  /* relative; w: LIGHT_KIND_ */
    vec4 lights_direction[LIGHTS_MAX]; /* unit; w: 1 / range^2, 0: none */
    vec4 lights_color[LIGHTS_MAX];     /* colour times intensity */
    vec4 lights_cone[LIGHTS_MAX];      /* KHR_lights_punctual: angular scale, angular offset */
    vec4 picture;                      /* exposure factor, ambient radiance, samples a side (aa), unused */
    vec4 background;                   /* as shown */
};

/* What `soft` blurs by, and the picture's size. */
BLOCK(soft_block, 6)
{
    vec4
        soft_light; /* radius of the blur where an occluder is half way to the light, scene units; side of a block of ranges, texels; unused */
    uvec4 soft_size; /* pixels; unused */
};

#endif
