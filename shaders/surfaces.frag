/* Pixels from ids: attributes by barycentrics, textures by hand (materials vary from pixel to pixel). The depth is the exact plane of the
 * triangle, not the rasterizer's (GL snaps vertices to 1/256 pixel). EMISSION: second output, emitted radiance and occlusion;
 * occlusion -1: unlit, and the radiance is the picture. */
#include "surface.glsl"

layout(binding = UNIT_IDS) uniform usampler2D ids;
layout(location = 0) out uvec4 packed_pixel;
#ifdef EMISSION
layout(location = 1) out vec4 emission;
#endif

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint id = texelFetch(ids, pixel, 0).x;
    packed_pixel = uvec4(0);
#ifdef EMISSION
    emission = vec4(0);
#endif
    /* A loop, not a condition: software rasterizers leave it when no lane is in it. */
    for (int once = 0; once < (id != NO_TRIANGLE ? 1 : 0); once++) {
        vec3 origin, direction;
        pixel_ray(pixel, origin, direction);
        Surface s = surface_at(id, origin, direction);
        packed_pixel = pixel_pack(s.geometric, s.depth, s.normal, s.metallic, s.base_color, s.roughness);
#ifdef EMISSION
        emission = s.unlit ? vec4(s.base_color, -1) : vec4(s.emissive, s.occlusion);
#endif
    }
}
