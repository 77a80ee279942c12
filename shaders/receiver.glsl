/* The pixel's receiver for the light at hand: what every shadow system starts from. LIGHT: LIGHT_KIND_ of it. */
#include "pixel.glsl"

layout(binding = UNIT_PIXELS) uniform usampler2D pixels;

struct Receiver {
    vec3 point;     /* relative */
    vec3 normal;    /* unit, geometric, turned to the eye */
    vec3 to_light;  /* unit */
    float cosine;   /* normal . to_light, > 0 for a receiver */
    float distance; /* to the light; 0 for a directional one */
};

/* False: no surface, or it faces away from the light, or lies outside its cone or range; visibility is 0 there. */
bool receiver_at(ivec2 pixel, out Receiver r)
{
    uvec4 p = texelFetch(pixels, pixel, 0);
    float depth = pixel_depth(p);
    vec3 origin, direction;
    pixel_ray(pixel, origin, direction);
    r.point = origin + depth * direction;
    r.normal = pixel_geometric(p);
    bool inside = depth > 0.0;
    if (LIGHT == LIGHT_KIND_DIRECTIONAL) {
        r.to_light = -light_direction.xyz;
        r.distance = 0.0;
    } else {
        vec3 v = light_position.xyz - r.point;
        float d2 = dot(v, v), inverse = inversesqrt(max(d2, 1e-37));
        r.distance = d2 * inverse;
        r.to_light = v * inverse;
        inside = inside && (light_direction.w == 0.0 || r.distance <= light_direction.w);
        if (LIGHT == LIGHT_KIND_SPOT)
            inside = inside && -dot(r.to_light, light_direction.xyz) >= light_cone.x;
    }
    r.cosine = dot(r.normal, r.to_light);
    return inside && r.cosine > 0.0;
}
