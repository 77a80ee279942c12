/* The light's depth maps, as shadow/fit.c lays them out. Depth texels hold near / depth (perspective) or (far - depth) / (far - near)
 * (orthographic): reversed, so that float precision is spent evenly; 0 = no caster. */
#include "receiver.glsl"

layout(binding = UNIT_SHADOW_MAP) uniform sampler2DArray shadow_map;

struct MapPoint {
    int layer;       /* -1: outside every map, so lit */
    vec2 texel;      /* position in the map, texels */
    float depth;     /* along the map's axis */
    float texel_size; /* of a texel at that depth, scene units */
};

/* The map whose picture holds `point` (relative). */
MapPoint map_point(vec3 point)
{
    MapPoint m = MapPoint(-1, vec2(0), 0.0, 0.0);
    float side = float(map_counts.y);
    for (int i = 0; i < int(map_counts.x); i++) {
        vec4 p = vec4(point, 1);
        vec3 q = vec3(dot(map_rows[3 * i], p), dot(map_rows[3 * i + 1], p), dot(map_rows[3 * i + 2], p));
        bool perspective = map_depth[i].z == 0.0;
        float w = perspective ? q.z : 1.0;
        vec2 texel = q.xy / w * map_scale[i].xy + map_scale[i].zw;
        bool inside = w > 0.0 && all(greaterThanEqual(texel, vec2(0))) && all(lessThan(texel, vec2(side)));
        if (m.layer < 0 && inside)
            m = MapPoint(i, texel, q.z, map_depth[i].w * w);
    }
    return m;
}

/* How far before the stored depth a point counts as lit: constant + slope x texel x tan(angle of incidence). */
float map_bias(Receiver r, MapPoint m, float constant_bias, float slope)
{
    float tangent = sqrt(max(1.0 - r.cosine * r.cosine, 0.0)) / r.cosine;
    return constant_bias + slope * m.texel_size * tangent;
}

/* 1 if a point at m.depth - bias is no farther than what texel `at` holds. Without a division: depth' <= near / stored. */
float map_lit(MapPoint m, ivec2 at, float bias)
{
    float stored = texelFetch(shadow_map, ivec3(at, m.layer), 0).x;
    vec4 d = map_depth[m.layer];
    float depth = m.depth - bias;
    bool lit = d.z == 0.0 ? stored * depth <= d.x : stored == 0.0 || depth <= d.y - stored * (d.y - d.x);
    return lit ? 1.0 : 0.0;
}
