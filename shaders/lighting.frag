/* Light times visibility, summed; never asks which shadow system ran. SHOW: enum show of renderer.h. */
#include "surface.glsl"

layout(binding = UNIT_IDS) uniform usampler2D ids;
layout(binding = UNIT_RECEIVERS) uniform sampler2D receivers;
layout(binding = UNIT_VISIBILITY) uniform sampler2DArray visibility;
layout(location = 0) out vec4 color;

const int SHOW_SHADED = 0, SHOW_VISIBILITY = 1, SHOW_DEPTH = 2, SHOW_NORMAL = 3, SHOW_ID = 4;

vec3 arriving(int i, vec3 point, out vec3 l)
{
    if (lights_position[i].w == float(LIGHT_KIND_DIRECTIONAL)) {
        l = -lights_direction[i].xyz;
        return lights_color[i].rgb;
    }
    vec3 v = lights_position[i].xyz - point;
    float d2 = max(dot(v, v), 1e-12), range = lights_direction[i].w;
    l = v * inversesqrt(d2);
    float fall = 1.0 / d2;
    if (range > 0.0) {
        float q = d2 / (range * range);
        fall *= clamp(1.0 - q * q, 0.0, 1.0);
    }
    if (lights_position[i].w == float(LIGHT_KIND_SPOT)) {
        float a = clamp(-dot(l, lights_direction[i].xyz) * lights_cone[i].x + lights_cone[i].y, 0.0, 1.0);
        fall *= a * a;
    }
    return lights_color[i].rgb * fall;
}

vec3 shaded(ivec2 pixel, uint id, vec4 receiver, vec3 point, vec3 to_eye)
{
    Surface s = surface_at(id, point, to_eye, receiver);
    if (s.unlit)
        return s.base_color / picture.x;
    vec3 sum = s.emissive + s.base_color * (picture.y * s.occlusion);
    for (int i = 0; i < int(view_counts.z); i++) {
        float v = texelFetch(visibility, ivec3(pixel, i), 0).x;
        vec3 l;
        vec3 e = arriving(i, point, l);
        sum += brdf_times_cosine(s, l) * e * v;
    }
    return sum;
}

vec3 id_color(uint id)
{
    uint h = id * 2654435761u;
    h ^= h >> 15;
    h *= 2246822519u;
    h ^= h >> 13;
    return 0.15 + 0.85 * vec3(h & 255u, (h >> 8) & 255u, (h >> 16) & 255u) / 255.0;
}

float mean_visibility(ivec2 pixel)
{
    float sum = 0.0;
    for (int i = 0; i < int(view_counts.z); i++)
        sum += texelFetch(visibility, ivec3(pixel, i), 0).x;
    return sum / float(max(view_counts.z, 1u));
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint id = texelFetch(ids, pixel, 0).x;
    vec4 receiver = texelFetch(receivers, pixel, 0);
    vec3 c = background.rgb;
    for (int once = 0; once < (id != NO_TRIANGLE ? 1 : 0); once++) {
        vec3 origin, direction;
        view_pixel_ray(pixel, origin, direction);
        vec3 point = origin + receiver.w * direction;
        if (SHOW == SHOW_SHADED)
            c = shaded(pixel, id, receiver, point, normalize(-direction)) * picture.x;
        else if (SHOW == SHOW_VISIBILITY)
            c = vec3(mean_visibility(pixel));
        else if (SHOW == SHOW_DEPTH)
            c = vec3(1.0 - exp2(-picture.w / receiver.w));
        else if (SHOW == SHOW_NORMAL)
            c = receiver.xyz * 0.5 + 0.5;
        else
            c = id_color(id);
    }
#ifdef RESOLVE_LATER
    color = vec4(c, 1);
#else
    color = vec4(SHOW == SHOW_SHADED || SHOW == SHOW_VISIBILITY || id == NO_TRIANGLE ? display_color(c) : c, 1);
#endif
}
