/* The pixel's receiver for the light at hand: what every shadow system starts from. */
#include "blocks.h"

layout(binding = UNIT_RECEIVERS) uniform sampler2D receivers;

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
    vec4 texel = texelFetch(receivers, pixel, 0);
    vec3 origin = ray_origin.xyz + float(pixel.x) * ray_origin_dx.xyz + float(pixel.y) * ray_origin_dy.xyz;
    vec3 direction = ray_direction.xyz + float(pixel.x) * ray_direction_dx.xyz + float(pixel.y) * ray_direction_dy.xyz;
    r.point = origin + texel.w * direction;
    r.normal = texel.xyz;
    bool inside = texel.w > 0.0;
    if (light_position.w == float(LIGHT_KIND_DIRECTIONAL)) {
        r.to_light = -light_direction.xyz;
        r.distance = 0.0;
    } else {
        vec3 v = light_position.xyz - r.point;
        r.distance = length(v);
        r.to_light = v / max(r.distance, 1e-30);
        inside = inside && (light_direction.w == 0.0 || r.distance <= light_direction.w);
        if (light_position.w == float(LIGHT_KIND_SPOT))
            inside = inside && -dot(r.to_light, light_direction.xyz) >= light_cone.x;
    }
    r.cosine = dot(r.normal, r.to_light);
    return inside && r.cosine > 0.0;
}
