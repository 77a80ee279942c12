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
    bool lit = true;
    if (receives && p.map >= 0) {
        uint id = texelFetch(ids, pixel, 0).x;
        lit = asm_lit(p, asm_leaf(p.root, p.place, ASM_LEVELS), id, r.tangent, PARAM(SLOPE));
    }
    visibility = receives && lit ? 1.0 : 0.0;
}
