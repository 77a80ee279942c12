/* struct pixel of renderer/scene/pixel.h: x geometric normal, y depth, z shading normal and metallic, w colour and roughness. */
#include "blocks.h"

/* Of the right direction, of any length in [0.57, 1]. */
vec3 octahedral_raw(vec2 e)
{
    vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    float t = max(-n.z, 0.0);
    n.xy += vec2(n.x >= 0.0 ? -t : t, n.y >= 0.0 ? -t : t);
    return n;
}

vec3 octahedral_unfold(vec2 e) { return normalize(octahedral_raw(e)); }

vec2 octahedral_fold(vec3 n)
{
    vec2 e = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    vec2 folded = (1.0 - abs(e.yx)) * vec2(e.x >= 0.0 ? 1.0 : -1.0, e.y >= 0.0 ? 1.0 : -1.0);
    return n.z < 0.0 ? folded : e;
}

vec3 pixel_geometric(uvec4 p) { return octahedral_unfold(unpackSnorm2x16(p.x)); }
float pixel_depth(uvec4 p) { return uintBitsToFloat(p.y); }
vec3 pixel_shading(uvec4 p) { return octahedral_unfold(vec2(p.z & 4095u, (p.z >> 12) & 4095u) / 2047.5 - 1.0); }
float pixel_metallic(uvec4 p) { return float(p.z >> 24) / 255.0; }
float pixel_roughness(uvec4 p) { return float(p.w >> 24) / 255.0; }

vec3 pixel_color(uvec4 p)
{
    vec3 root = vec3(p.w & 255u, (p.w >> 8) & 255u, (p.w >> 16) & 255u) / 255.0;
    return root * root;
}

uvec4 pixel_pack(vec3 geometric, float depth, vec3 shading, float metallic, vec3 color, float roughness)
{
    uvec2 s = uvec2((octahedral_fold(shading) + 1.0) * 2047.5 + 0.5);
    vec4 c = vec4(sqrt(clamp(color, 0.0, 1.0)), clamp(roughness, 0.0, 1.0));
    return uvec4(packSnorm2x16(octahedral_fold(geometric)), floatBitsToUint(depth),
                 s.x | s.y << 12 | uint(clamp(metallic, 0.0, 1.0) * 255.0 + 0.5) << 24, packUnorm4x8(c));
}

/* The ray through the centre of a pixel, relative. */
void pixel_ray(ivec2 pixel, out vec3 origin, out vec3 direction)
{
    origin = ray_origin.xyz + float(pixel.x) * ray_origin_dx.xyz + float(pixel.y) * ray_origin_dy.xyz;
    direction = ray_direction.xyz + float(pixel.x) * ray_direction_dx.xyz + float(pixel.y) * ray_direction_dy.xyz;
}
