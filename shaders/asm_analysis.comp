/* What the camera needs of the trees: one pixel in asm_counts.z is looked at. Counters only grow by additions, so their sum does not depend on
 * the order of the pixels. Fernando et al. 2001: the benefit of refining a cell = pixels across a discontinuity in it whose texels are too
 * large. */
#include "asm.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = UNIT_IDS) uniform usampler2D ids;

/* For each cell of each slot: the benefit of a page there, over all pixels. Then for each slot: what its page's would be, were it not
 * there; whether a pixel used it. Then for each level: pixels at a shadow's boundary that found it. */
layout(std430, binding = 0) buffer counters
{
    uint counter[];
};

const int DARK = 0, LIT = 1, IN_DOUBT = 2;
/* Benefit of a finer page to a pixel: an edge that is seen comes before one that may be there. */
const uint EDGE = 4u, DOUBT = 1u;

/* What a leaf says of the point. In doubt: it hangs on the bias, lit only for it or dark by less than as much again. */
int answer(AsmPlace p, AsmLeaf leaf, uint id, float tangent, float slope)
{
    float stored = texelFetch(asm_depths, leaf.texel, 0).x;
    float seen_at = MAP_PERSPECTIVE != 0 ? p.range.x / max(stored, 1e-37) : p.range.y - stored * (p.range.y - p.range.x);
    float behind = p.depth - seen_at, bias = asm_bias(p, leaf.level, tangent, slope);
    if (stored == 0.0 || behind <= 0.0 || texelFetch(asm_ids, leaf.texel, 0).x == id)
        return LIT;
    return behind <= 2.0 * bias ? IN_DOUBT : DARK;
}

/* Do the four texels of `level` whose centres are around the place not all agree? Three of them lie up to one and a half texels away, along the
 * receiver's plane: so their slope. */
bool is_ambiguous(AsmPlace p, int level, ivec2 toward, uint id, float tangent)
{
    ivec2 last = ivec2(asm_counts.x - 1);
    float slope = PARAM(SLOPE);
    bool lit = asm_lit(p, asm_leaf(p.root, p.place, level), id, tangent, slope);
    bool same = true;
    for (int i = 1; i < 4 && same; i++) {
        ivec2 beside = clamp(p.place + ivec2(i & 1, i >> 1) * toward, ivec2(0), last);
        same = asm_lit(p, asm_leaf(p.root, beside, level), id, tangent, slope + 1.0) == lit;
    }
    return !same;
}

/* EDGE, DOUBT or 0: the same of texels larger than a pixel, more warily. What is smaller than they are may lie between them; their bias is large, so all
 * may agree on an answer that is wrong: at the foot of things, in folds. So all next to the place's own count, and doubt is enough. */
uint edge_or_doubt(AsmPlace p, int level, ivec2 toward, uint id, float tangent)
{
    ivec2 last = ivec2(asm_counts.x - 1);
    int own = answer(p, asm_leaf(p.root, p.place, level), id, tangent, PARAM(SLOPE)), found = 1 << own;
    for (int i = 0; i < 9 && found != 3 && found != 7; i++) {
        ivec2 beside = clamp(p.place + ivec2(i % 3 - 1, i / 3 - 1) * toward, ivec2(0), last);
        found |= 1 << answer(p, asm_leaf(p.root, beside, level), id, tangent, PARAM(SLOPE));
    }
    return (found & 3) == 3 ? EDGE : (found & 4) != 0 ? DOUBT : 0u;
}

/* What finer texels than those of `level` would be to the pixel. */
uint wants_finer(AsmPlace p, int level, float too_large, uint id, float tangent)
{
    float rest = too_large * exp2(float(-4 * level));
    int texel = 1 << (FINEST - 2 * level), half_bit = max(texel >> 1, 1);
    ivec2 toward = ivec2((p.place.x & half_bit) != 0 ? texel : -texel, (p.place.y & half_bit) != 0 ? texel : -texel);
    if (rest > PARAM(DETAIL) * PARAM(DETAIL))
        return edge_or_doubt(p, level, toward, id, tangent);
    return rest > 1.0 && is_ambiguous(p, level, toward, id, tangent) ? EDGE : 0u;
}

/* Times by which a root texel's area exceeds what is wanted: a pixel's footprint on the surface, seen from the light, over detail^2. */
float excess(AsmPlace p, Receiver r, ivec2 pixel)
{
    vec3 origin, direction;
    pixel_ray(pixel, origin, direction);
    float depth = dot(view_forward.xyz, r.point - origin);
    float side = view_forward.w * (view_clip.z == 0.0 ? depth : 1.0);
    float to_axis = MAP_PERSPECTIVE != 0 ? p.w / max(r.distance, 1e-30) : 1.0;
    float area = side * side / max(abs(dot(r.normal, direction)), 0.1) * max(r.cosine, 0.1) / max(to_axis, 0.1);
    float texel = asm_texel.x * asm_texel.y * p.w * p.w;
    return texel * PARAM(DETAIL) * PARAM(DETAIL) / max(area, 1e-37);
}

/* 2: no receiver. */
int visible(ivec2 pixel)
{
    Receiver r;
    if (any(greaterThanEqual(pixel, textureSize(pixels, 0))) || !receiver_at(pixel, r))
        return 2;
    AsmPlace p = asm_place(r.point);
    if (p.map < 0)
        return 1;
    AsmLeaf leaf = asm_leaf(p.root, p.place, ASM_LEVELS);
    return asm_lit(p, leaf, texelFetch(ids, pixel, 0).x, r.tangent, PARAM(SLOPE)) ? 1 : 0;
}

bool at_boundary(ivec2 pixel, int here)
{
    int right = visible(pixel + ivec2(1, 0)), below = visible(pixel + ivec2(0, 1));
    return right + here == 1 || below + here == 1;
}

void main()
{
    int every = asm_counts.z, row = int(gl_GlobalInvocationID.y);
    ivec2 pixel = ivec2(int(gl_GlobalInvocationID.x) * every + (asm_counts.w + 3 * row) % every, row);
    if (any(greaterThanEqual(pixel, textureSize(pixels, 0))))
        return;
    Receiver r;
    if (!receiver_at(pixel, r))
        return;
    AsmPlace p = asm_place(r.point);
    if (p.map < 0)
        return;
    uint id = texelFetch(ids, pixel, 0).x;
    AsmLeaf leaf = asm_leaf(p.root, p.place, ASM_LEVELS);
    int slots = asm_counts.y;
    counter[slots * 17 + leaf.slot] = 1u;
    float too_large = excess(p, r, pixel);
    uint benefit = leaf.level < ASM_LEVELS ? wants_finer(p, leaf.level, too_large, id, r.tangent) : 0u;
    if (benefit > 0u)
        atomicAdd(counter[leaf.slot * 16 + leaf.cell], benefit);
    uint worth = leaf.level > 0 ? wants_finer(p, leaf.level - 1, too_large, id, r.tangent) : 0u;
    if (worth > 0u)
        atomicAdd(counter[slots * 16 + leaf.slot], worth);
    int here = asm_lit(p, leaf, id, r.tangent, PARAM(SLOPE)) ? 1 : 0;
    if (at_boundary(pixel, here))
        atomicAdd(counter[slots * 18 + leaf.level], 1u);
}
