/* Fernando et al. 2001, "Adaptive Shadow Maps": lit if the finest page at the point sees the point's own triangle, or nothing before it. */
#include "asm.glsl"

layout(binding = UNIT_IDS) uniform usampler2D ids;

layout(location = 0) out float visibility;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Receiver r;
    bool receives = receiver_at(pixel, r);
    AsmPlace p = asm_place(r.point);
    AsmLeaf leaf = asm_leaf(p.root, p.map < 0 ? ivec2(0) : p.place, receives && p.map >= 0 ? ASM_LEVELS : 0);
    bool dark = receives && p.map >= 0 && !asm_nearest(p, leaf, r.tangent, PARAM(SLOPE));
    /* The test by triangle comes second here and last in no answer: it can only make a point lit. A loop, not a condition: software
     * rasterizers leave it when no lane is in it. */
    for (int once = 0; once < (dark ? 1 : 0); once++)
        dark = texelFetch(asm_ids, leaf.texel, 0).x != texelFetch(ids, pixel, 0).x;
    visibility = receives && !dark ? 1.0 : 0.0;
}
