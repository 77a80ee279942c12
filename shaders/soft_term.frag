/* First pass of `soft` (docs/filtered.md): the shadow term, and how far it will be blurred at each pixel. */
#include "maps.glsl"
#include "params.glsl"
#include "soft_term.glsl"

layout(location = 0) out uint term;
layout(location = 1) out uint radius;

layout(binding = UNIT_MAP_RANGES) uniform sampler2DArray ranges;

const int BIAS = 2, SLOPE = 3, NEAR = 4, FAR = 5, LIFT = 6;
const int SEARCH = 4; /* taps a side */

/* What a depth texel would hold at `depth`. */
float stored_at(MapPoint m, float depth)
{
    return MAP_PERSPECTIVE != 0 ? m.range.x / depth : max((m.range.y - depth) / (m.range.y - m.range.x), 0.0);
}

float depth_of(MapPoint m, float stored)
{
    return MAP_PERSPECTIVE != 0 ? m.range.x / stored : m.range.y - stored * (m.range.y - m.range.x);
}

/* Change of what the receiver's plane stores, a texel along x and y: both encodings are affine over a plane's picture. */
vec2 plane_slope(MapPoint m, Receiver r)
{
    int i = 3 * m.layer;
    vec3 n = vec3(dot(map_rows[i].xyz, r.normal), dot(map_rows[i + 1].xyz, r.normal), dot(map_rows[i + 2].xyz, r.normal));
    vec2 scale = map_scale[m.layer].xy;
    if (MAP_PERSPECTIVE == 0)
        return n.xy / (n.z * scale * (m.range.y - m.range.x));
    vec2 tangent = (m.texel - map_scale[m.layer].zw) / scale;
    return m.range.x / m.depth * n.xy / (scale * (dot(n.xy, tangent) + n.z));
}

/* How far an occluder at `depth` blurs its shadow at the receiver, scene units across the light. */
float blur_radius(MapPoint m, float depth)
{
    float away = MAP_PERSPECTIVE != 0 ? (m.depth - depth) / depth : (m.depth - depth) / (m.range.y - m.range.x);
    return soft_light.x * clamp(away, 0.0, PARAM(FAR));
}

/* Lengths across the light of a pixel's step along x and y over the receiver. */
vec2 pixel_steps(ivec2 pixel, Receiver r, float depth)
{
    vec3 origin, d;
    pixel_ray(pixel, origin, d);
    bool parallel = view_clip.z != 0.0;
    vec3 x = parallel ? ray_origin_dx.xyz : depth * ray_direction_dx.xyz;
    vec3 y = parallel ? ray_origin_dy.xyz : depth * ray_direction_dy.xyz;
    float n_d = dot(r.normal, d);
    x -= d * (dot(r.normal, x) / n_d);
    y -= d * (dot(r.normal, y) / n_d);
    x -= r.to_light * dot(x, r.to_light);
    y -= r.to_light * dot(y, r.to_light);
    return vec2(length(x), length(y));
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Receiver r;
    bool receives = receiver_at(pixel, r);
    MapPoint m = map_point(r.point);
    float depth = pixel_depth(texelFetch(pixels, pixel, 0));
    bool sampled = receives && m.layer >= 0;
    m.layer = max(m.layer, 0);
    float side = float(map_counts.y), block = soft_light.y;
    vec2 range = texelFetch(ranges, ivec3(ivec2(m.texel / block), m.layer), 0).xy;
    float own = stored_at(m, m.depth - map_bias(r, m, PARAM(BIAS), PARAM(SLOPE)));
    vec2 slope = plane_slope(m, r);
    float spread = 2.0 * block * (abs(slope.x) + abs(slope.y));
    bool all_lit = range.x <= max(own - spread, 0.0), all_dark = range.y > own + spread;
    /* The nearest occluder round here bounds how far to look. */
    float reach = min(blur_radius(m, depth_of(m, range.x)) / m.texel_size, block);
    bool search = sampled && !all_lit && !all_dark;

    /* Four texels, interpolated: the term's own edge is one texel wide. */
    vec2 corner = m.texel - 0.5, base = floor(corner), part = corner - base;
    vec4 four = textureGather(shadow_map, vec3((base + 1.0) / side, float(m.layer)));
    vec2 o = base + 0.5 - m.texel;
    vec4 planes = max(own + vec4(dot(slope, o + vec2(0, 1)), dot(slope, o + vec2(1, 1)), dot(slope, o + vec2(1, 0)), dot(slope, o)), 0.0);
    vec4 blocked = vec4(greaterThan(four, planes));
    vec4 weights = vec4((1.0 - part.x) * part.y, part.x * part.y, part.x * (1.0 - part.y), (1.0 - part.x) * (1.0 - part.y));
    float dark = dot(blocked, weights);
    float sum = dot(blocked, four), count = dot(blocked, vec4(1));

    for (int i = 0; i < (search ? SEARCH * SEARCH : 0); i++) {
        vec2 offset = (vec2(i % SEARCH, i / SEARCH) * (2.0 / float(SEARCH - 1)) - 1.0) * reach;
        vec2 at = floor(m.texel + offset);
        float stored = texelFetch(shadow_map, ivec3(clamp(at, vec2(0), vec2(side - 1.0)), m.layer), 0).x;
        float hit = stored > max(own + dot(slope, at + 0.5 - m.texel), 0.0) ? 1.0 : 0.0;
        sum += hit * stored;
        count += hit;
    }
    float across = count > 0.0 ? blur_radius(m, depth_of(m, sum / count)) : 0.0;
    float lift = PARAM(LIFT) * across / max(soft_light.x * PARAM(FAR), 1e-30);
    float lit = sampled ? 1.0 - dark * (1.0 - lift) : 1.0;
    vec2 sigma = search && count > 0.0 ? max(0.5 * across / pixel_steps(pixel, r, depth), vec2(PARAM(NEAR))) : vec2(0);
    term = receives ? term_pack(lit, view_clip.z != 0.0 ? depth : 1.0 / depth) : 0u;
    radius = packHalf2x16(min(sigma, vec2(1000)));
}
