/* The surface that a ray meets on a triangle, by the triangle's id. */
#include "pixel.glsl"
#include "scene_fetch.glsl"
#include "tonemap.glsl"

struct Surface {
    vec3 geometric;   /* unit, turned to the eye */
    float depth;      /* along the ray */
    vec3 normal;      /* shading, unit, on the geometric normal's side */
    vec3 base_color;
    vec3 emissive;
    float metallic, roughness, occlusion;
    bool unlit;
};

#ifdef TEXTURES
#include "holes.glsl"
layout(binding = UNIT_TEXCOORDS) uniform samplerBuffer texcoord_texels;
#else
layout(binding = UNIT_MATERIALS) uniform samplerBuffer materials;
#endif
#ifdef COLORS
layout(binding = UNIT_COLORS) uniform samplerBuffer color_texels;
#endif

vec3 unpack_normal(uint bits) { return octahedral_unfold(unpackSnorm2x16(bits)); }

/* Barycentrics of p in the plane of the triangle, weights of b and c. */
vec2 barycentrics(Triangle t, vec3 p)
{
    vec3 e0 = t.b - t.a, e1 = t.c - t.a, e2 = p - t.a;
    float d00 = dot(e0, e0), d01 = dot(e0, e1), d11 = dot(e1, e1), d20 = dot(e2, e0), d21 = dot(e2, e1);
    float scale = 1.0 / max(d00 * d11 - d01 * d01, 1e-38);
    return vec2(d11 * d20 - d01 * d21, d00 * d21 - d01 * d20) * scale;
}

vec3 mesh_normal_to_relative(uint instance, vec3 n)
{
    /* The cofactor matrix takes normals along, whatever the scale; its sign follows a mirror. */
    int row = int(instance) * 3;
    vec3 r0 = texelFetch(rows, row).xyz, r1 = texelFetch(rows, row + 1).xyz, r2 = texelFetch(rows, row + 2).xyz;
    return vec3(dot(cross(r1, r2), n), dot(cross(r2, r0), n), dot(cross(r0, r1), n));
}

#ifdef TEXTURES
vec4 sample_level(uvec4 info, vec2 uv, uint level)
{
    ivec2 size = ivec2(info.y & 0xffffu, info.y >> 16);
    uint first = info.x;
    for (uint i = 0u; i < level; i++) {
        first += uint(size.x * size.y);
        size = max(size >> 1, ivec2(1));
    }
    vec2 at = uv * vec2(size) - 0.5;
    if ((info.z >> 16) != 0u && level == 0u)
        return unpackUnorm4x8(texel_at(info, size, first, ivec2(floor(at + 0.5))));
    ivec2 i = ivec2(floor(at));
    vec2 f = at - vec2(i);
    vec4 t00 = unpackUnorm4x8(texel_at(info, size, first, i)), t10 = unpackUnorm4x8(texel_at(info, size, first, i + ivec2(1, 0)));
    vec4 t01 = unpackUnorm4x8(texel_at(info, size, first, i + ivec2(0, 1)));
    vec4 t11 = unpackUnorm4x8(texel_at(info, size, first, i + ivec2(1, 1)));
    return mix(mix(t00, t10, f.x), mix(t01, t11, f.x), f.y);
}

/* One use of a texture; `fallback` where the material has none. density: texture coordinates' area a pixel, before the texture's size. */
vec4 sample_use(uint material, int use, vec4 texcoords, float density, vec4 fallback)
{
    int use_texel = int(material) * MATERIAL_TEXELS + use;
    float index = texelFetch(materials, use_texel).x;
    vec4 value = fallback;
    for (int once = 0; once < (index >= 0.0 ? 1 : 0); once++) {
        uvec4 info = texelFetch(textures, int(index));
        vec2 size = vec2(info.y & 0xffffu, info.y >> 16);
        float level = 0.5 * log2(max(density * size.x * size.y, 1.0));
        value = sample_level(info, transformed_texcoord(use_texel, texcoords), min(uint(level + 0.5), info.w - 1u));
    }
    return value;
}

vec3 mapped_normal(vec3 n, vec3 texel, float scale, vec3 tangent, vec3 bitangent)
{
    vec3 m = texel * 2.0 - 1.0;
    return normalize(tangent * (m.x * scale) + bitangent * (m.y * scale) + n * max(m.z, 0.05));
}
#endif

Surface surface_at(uint id, vec3 origin, vec3 direction)
{
    Triangle t = triangle_at(id);
    Surface s;
    vec3 across = cross(t.b - t.a, t.c - t.a);
    float facing = dot(across, direction);
    s.depth = dot(across, t.a - origin) / facing;
    s.geometric = normalize(facing > 0.0 ? -across : across);
    vec3 point = origin + s.depth * direction;
    vec2 w = barycentrics(t, point);
    vec3 weights = vec3(1.0 - w.x - w.y, w);
    int texel = int(t.material) * MATERIAL_TEXELS;
    vec4 base = texelFetch(materials, texel), factors = texelFetch(materials, texel + 1), emissive = texelFetch(materials, texel + 2);
    vec3 n = mat3(unpack_normal(t.normal.x), unpack_normal(t.normal.y), unpack_normal(t.normal.z)) * weights;
    n = normalize(mesh_normal_to_relative(t.instance, n));
    s.normal = dot(n, s.geometric) < 0.0 ? -n : n;
    s.base_color = base.rgb;
    s.metallic = factors.x;
    s.roughness = factors.y;
    s.occlusion = 1.0;
    s.emissive = emissive.rgb;
    s.unlit = factors.x < 0.0;
#ifdef COLORS
    vec4 ca = texelFetch(color_texels, int(t.vertex.x)), cb = texelFetch(color_texels, int(t.vertex.y));
    vec4 cc = texelFetch(color_texels, int(t.vertex.z));
    s.base_color *= (ca * weights.x + cb * weights.y + cc * weights.z).rgb;
#endif
#ifdef TEXTURES
    vec4 ua = texelFetch(texcoord_texels, int(t.vertex.x)), ub = texelFetch(texcoord_texels, int(t.vertex.y));
    vec4 uc = texelFetch(texcoord_texels, int(t.vertex.z));
    vec4 uv = ua * weights.x + ub * weights.y + uc * weights.z;
    vec2 e0 = ub.xy - ua.xy, e1 = uc.xy - ua.xy;
    vec3 p0 = t.b - t.a, p1 = t.c - t.a;
    float pixel = view_forward.w * (view_clip.z == 0.0 ? s.depth : 1.0);
    float uv_area = e0.x * e1.y - e0.y * e1.x;
    float density = abs(uv_area) / max(length(cross(p0, p1)), 1e-30) * pixel * pixel / max(abs(dot(s.geometric, normalize(direction))), 0.25);
    s.base_color *= linear_from_srgb(sample_use(t.material, MATERIAL_BASE_COLOR, uv, density, vec4(1)).rgb);
    vec4 mr = sample_use(t.material, MATERIAL_METALLIC_ROUGHNESS, uv, density, vec4(1));
    s.metallic *= mr.b;
    s.roughness *= mr.g;
    s.occlusion = 1.0 + factors.w * (sample_use(t.material, MATERIAL_OCCLUSION, uv, density, vec4(1)).r - 1.0);
    s.emissive *= linear_from_srgb(sample_use(t.material, MATERIAL_EMISSIVE, uv, density, vec4(1)).rgb);
    vec3 map = sample_use(t.material, MATERIAL_NORMAL, uv, density, vec4(0.5, 0.5, 1, 1)).rgb;
    if (uv_area != 0.0) {
        vec3 tangent = normalize((p0 * e1.y - p1 * e0.y) * sign(uv_area)), bitangent = normalize((p1 * e0.x - p0 * e1.x) * sign(uv_area));
        s.normal = mapped_normal(s.normal, map, factors.z, tangent, bitangent);
    }
#endif
    return s;
}
