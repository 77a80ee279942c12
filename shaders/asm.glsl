/* The trees of an adaptive shadow map (shadow/asm/): where a point lies in them, and what the finest page there says of it. MAPS,
 * MAP_PERSPECTIVE: as for maps.glsl, whose encoding of depths this shares. */
#include "receiver.glsl"
#include "params.glsl"

layout(binding = UNIT_SHADOW_MAP) uniform sampler2D asm_depths;
layout(binding = UNIT_ASM_IDS) uniform usampler2D asm_ids;
layout(binding = UNIT_ASM_TABLE) uniform usamplerBuffer asm_table;

const int BIAS = 2, SLOPE = 3, DETAIL = 4;
/* Beyond it the bias grows no more: near the terminator it would reach through whole objects, and there the triangle's id protects it. */
const float TANGENT_MAX = 8.0;
const int FINEST = 2 * ASM_LEVELS; /* bits of a finest texel's number below the root's */

struct AsmPlace {
    int map;     /* -1: outside all, so lit */
    ivec2 place; /* in finest texels */
    float depth; /* along the map's axis */
    float w;     /* 1 or the depth: scales a texel */
    vec2 range;  /* near and far */
    ivec2 root;  /* column and row of its first slot */
};

/* A constant count, so that the loop unrolls. */
AsmPlace asm_place(vec3 point)
{
    AsmPlace p = AsmPlace(-1, ivec2(0), 0.0, 1.0, vec2(1), ivec2(0));
    vec4 at = vec4(point, 1);
    for (int i = 0; i < MAPS; i++) {
        vec3 q = vec3(dot(asm_rows[3 * i], at), dot(asm_rows[3 * i + 1], at), dot(asm_rows[3 * i + 2], at));
        float w = MAP_PERSPECTIVE != 0 ? q.z : 1.0;
        vec2 offset = clamp(q.xy / w, vec2(-536870912.0), vec2(536870912.0));
        ivec2 place = asm_base[i].xy + ivec2(floor(offset + asm_part[i].xy));
        bool inside = w > 0.0 && min(place.x, place.y) >= 0 && max(place.x, place.y) < asm_counts.x;
        if (p.map < 0 && inside)
            p = AsmPlace(i, place, q.z, w, asm_part[i].zw, asm_base[i].zw);
    }
    return p;
}

struct AsmLeaf {
    int slot;
    int cell; /* of the slot, holding the place */
    int level;
    ivec2 texel; /* in the pool */
};

/* The finest page that holds the place, of those at most `limit` levels deep. */
AsmLeaf asm_leaf(ivec2 root, ivec2 place, int limit)
{
    ivec2 page = place >> (FINEST + 4);
    AsmLeaf leaf;
    leaf.slot = (root.y + page.y) * ASM_COLUMNS + root.x + page.x;
    leaf.level = 0;
    int shift = FINEST + 2;
    ivec2 at = (place >> shift) & 3;
    leaf.cell = at.y * ASM_CELLS + at.x;
    int child = limit > 0 ? int(texelFetch(asm_table, leaf.slot * 16 + leaf.cell).x) : 0;
    for (; child != 0;) {
        leaf.slot = child;
        leaf.level++;
        shift -= 2;
        at = (place >> shift) & 3;
        leaf.cell = at.y * ASM_CELLS + at.x;
        child = leaf.level < limit ? int(texelFetch(asm_table, leaf.slot * 16 + leaf.cell).x) : 0;
    }
    ivec2 within = (place >> (shift - 2)) & 15;
    leaf.texel = ivec2(leaf.slot & (ASM_COLUMNS - 1), leaf.slot / ASM_COLUMNS) * ASM_PAGE + within;
    return leaf;
}

/* Side of a root texel at the place, scene units. */
float asm_texel_size(AsmPlace p) { return asm_texel.x * p.w; }

float asm_level_scale(int level) { return exp2(float(-2 * level)); }

/* slope: times the texel's size times the tangent of the angle of incidence. */
float asm_bias(AsmPlace p, int level, float tangent, float slope)
{
    return PARAM(BIAS) + slope * asm_texel_size(p) * asm_level_scale(level) * min(tangent, TANGENT_MAX);
}

/* Does the leaf see nothing before the point? */
bool asm_nearest(AsmPlace p, AsmLeaf leaf, float tangent, float slope)
{
    float stored = texelFetch(asm_depths, leaf.texel, 0).x;
    float depth = p.depth - asm_bias(p, leaf.level, tangent, slope);
    return MAP_PERSPECTIVE != 0 ? stored * depth <= p.range.x
                                : stored == 0.0 || depth <= p.range.y - stored * (p.range.y - p.range.x);
}

/* By triangle, else by depth (Fernando et al. 2001, section "combining ID and depth"): the point's own triangle does not shadow it. */
bool asm_lit(AsmPlace p, AsmLeaf leaf, uint id, float tangent, float slope)
{
    return texelFetch(asm_ids, leaf.texel, 0).x == id || asm_nearest(p, leaf, tangent, slope);
}
