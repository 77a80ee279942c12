/* Light times visibility, summed; never asks which shadow system ran. SHOW: enum lighting_show. LIGHTS of them. */
#include "pixel.glsl"
#include "brdf.glsl"
#include "tonemap.glsl"

layout(binding = UNIT_IDS) uniform usampler2D ids;
layout(binding = UNIT_PIXELS) uniform usampler2D pixels;
layout(binding = UNIT_EMISSION) uniform sampler2D emission;
layout(binding = UNIT_VISIBILITY) uniform sampler2DArray visibility;
layout(location = 0) out vec4 color;

const int SHOW_SHADED = 0, SHOW_VISIBILITY = 1, SHOW_DEPTH = 2, SHOW_NORMAL = 3, SHOW_ID = 4;

/* Irradiance at normal incidence, without conditions: software rasterizers run both sides of every one. KINDS: what all lights are, -1 if they
 * differ. */
vec3 arriving(int i, vec3 point, out vec3 l)
{
    float kind = KINDS < 0 ? lights_position[i].w : float(KINDS);
    vec3 v = lights_position[i].xyz - point;
    float inverse = inversesqrt(max(dot(v, v), 1e-30)), fall = inverse * inverse;
    l = v * inverse;
    /* KHR_lights_punctual: range (0: none), then the cone. */
    float q = lights_direction[i].w / fall;
    fall *= clamp(1.0 - q * q, 0.0, 1.0);
    if (KINDS < 0 || KINDS == LIGHT_KIND_SPOT) {
        float a = clamp(-dot(l, lights_direction[i].xyz) * lights_cone[i].x + lights_cone[i].y, 0.0, 1.0);
        fall *= kind == float(LIGHT_KIND_SPOT) ? a * a : 1.0;
    }
    if (KINDS < 0 || KINDS == LIGHT_KIND_DIRECTIONAL) {
        bool parallel = kind == float(LIGHT_KIND_DIRECTIONAL);
        l = parallel ? -lights_direction[i].xyz : l;
        fall = parallel ? 1.0 : fall;
    }
    return lights_color[i].rgb * fall;
}

vec3 shaded(ivec2 pixel, uvec4 p)
{
    vec3 origin, direction;
    pixel_ray(pixel, origin, direction);
    vec3 point = origin + pixel_depth(p) * direction;
    Lit s = Lit(pixel_color(p), pixel_shading(p), normalize(-direction), pixel_metallic(p), pixel_roughness(p));
    float occlusion = 1.0;
    vec3 sum = vec3(0);
#ifdef EMISSION
    vec4 e = texelFetch(emission, pixel, 0);
    occlusion = e.w;
    sum = e.rgb;
#endif
    sum += s.base_color * (picture.y * occlusion);
    for (int i = 0; i < LIGHTS; i++) {
        float v = texelFetch(visibility, ivec3(pixel, i), 0).x;
        vec3 l;
        vec3 radiance = arriving(i, point, l);
        sum += brdf_times_cosine(s, l) * radiance * v;
    }
#ifdef EMISSION
    return e.w < 0.0 ? e.rgb : sum * picture.x;
#else
    return sum * picture.x;
#endif
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
    for (int i = 0; i < LIGHTS; i++)
        sum += texelFetch(visibility, ivec3(pixel, i), 0).x;
    return sum / float(max(LIGHTS, 1));
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uvec4 p = texelFetch(pixels, pixel, 0);
    float depth = pixel_depth(p);
    vec3 c;
    if (SHOW == SHOW_SHADED)
        c = shaded(pixel, p);
    else if (SHOW == SHOW_VISIBILITY)
        c = vec3(mean_visibility(pixel));
    else if (SHOW == SHOW_DEPTH)
        c = vec3(1.0 - exp2(-picture.w / depth));
    else if (SHOW == SHOW_NORMAL)
        c = pixel_geometric(p) * 0.5 + 0.5;
    else
        c = id_color(texelFetch(ids, pixel, 0).x);
    if (RESOLVE_LATER != 0)
        color = depth > 0.0 ? vec4(c, 1) : vec4(0);
    else
        color = depth > 0.0 ? vec4(display_color(c), 1) : background;
}
