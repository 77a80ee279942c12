/* The light's depth maps, as shadow/fit.c lays them out; MAPS of them, MAP_PERSPECTIVE or not. Depth texels hold near / depth
 * (perspective) or (far - depth) / (far - near) (orthographic): reversed, so that float precision is spent evenly; 0 = no caster. */
#include "receiver.glsl"

layout(binding = UNIT_SHADOW_MAP) uniform sampler2DArray shadow_map;

struct MapPoint {
    int layer;        /* -1: outside every map, so lit */
    vec2 texel;       /* position in the map, texels */
    float depth;      /* along the map's axis */
    float texel_size; /* of a texel at that depth, scene units */
    vec2 range;       /* near and far of the map */
};

/* The map whose picture holds `point` (relative). A constant count, so that the loop unrolls: indexing a uniform block by a variable is
 * slow on software rasterizers. */
MapPoint map_point(vec3 point)
{
    MapPoint m = MapPoint(-1, vec2(0), 0.0, 0.0, vec2(0));
    vec4 p = vec4(point, 1);
    float side = float(map_counts.y);
    for (int i = 0; i < MAPS; i++) {
        vec3 q = vec3(dot(map_rows[3 * i], p), dot(map_rows[3 * i + 1], p), dot(map_rows[3 * i + 2], p));
        float w = MAP_PERSPECTIVE != 0 ? q.z : 1.0;
        vec2 texel = q.xy / w * map_scale[i].xy + map_scale[i].zw;
        bool inside = w > 0.0 && min(texel.x, texel.y) >= 0.0 && max(texel.x, texel.y) < side;
        if (m.layer < 0 && inside)
            m = MapPoint(i, texel, q.z, map_depth[i].w * w, map_depth[i].xy);
    }
    return m;
}

/* How far before the stored depth a point counts as lit: constant + slope x texel x tan(angle of incidence). */
float map_bias(Receiver r, MapPoint m, float constant_bias, float slope)
{
    return constant_bias + slope * m.texel_size * r.tangent;
}

/* 1 if a point at `depth` is no farther than what texel `at` holds. Without a division: depth <= near / stored. */
float map_lit(MapPoint m, ivec2 at, float depth)
{
    float stored = texelFetch(shadow_map, ivec3(at, m.layer), 0).x;
    bool lit = MAP_PERSPECTIVE != 0 ? stored * depth <= m.range.x : stored == 0.0 || depth <= m.range.y - stored * (m.range.y - m.range.x);
    return lit ? 1.0 : 0.0;
}
