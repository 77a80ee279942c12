/* The pixel's receiver for the light at hand: what every shadow system starts from. LIGHT: LIGHT_KIND_ of it. */
#include "pixel.glsl"

layout(binding = UNIT_PIXELS) uniform usampler2D pixels;

/* What a system does not use costs nothing: compilers drop it. */
struct Receiver {
    vec3 point;     /* relative */
    vec3 normal;    /* unit, geometric, turned to the eye */
    vec3 to_light;  /* unit */
    float distance; /* to the light; 0 for a directional one */
    float cosine;   /* of the angle of incidence, > 0 for a receiver */
    float tangent;  /* of the same */
};

/* False: no surface, or it faces away from the light, or lies outside its cone or range; visibility is 0 there. */
bool receiver_at(ivec2 pixel, out Receiver r)
{
    uvec4 p = texelFetch(pixels, pixel, 0);
    float depth = pixel_depth(p);
    vec3 origin, direction;
    pixel_ray(pixel, origin, direction);
    r.point = origin + depth * direction;
    bool parallel = LIGHT == LIGHT_KIND_DIRECTIONAL;
    vec3 v = parallel ? -light_direction.xyz : light_position.xyz - r.point;
    vec3 n = octahedral_raw(unpackSnorm2x16(p.x));
    /* One square root for both lengths. */
    float d2 = dot(v, v), n_v = dot(n, v), lengths2 = dot(n, n) * d2;
    r.normal = normalize(n);
    r.to_light = normalize(v);
    r.distance = parallel ? 0.0 : sqrt(d2);
    r.cosine = n_v * inversesqrt(lengths2);
    r.tangent = sqrt(max(lengths2 / (n_v * n_v) - 1.0, 0.0));
    bool inside = depth > 0.0 && n_v > 0.0;
    if (!parallel)
        inside = inside && (light_direction.w == 0.0 || d2 <= light_direction.w * light_direction.w);
    if (LIGHT == LIGHT_KIND_SPOT)
        inside = inside && -dot(v, light_direction.xyz) >= light_cone.x * sqrt(d2);
    return inside;
}
