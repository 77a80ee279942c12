/* Reeves, Salesin, Cook 1987: the share of n x n neighbouring texels that see the point. */
#include "maps.glsl"
#include "params.glsl"

layout(location = 0) out float visibility;

const int BIAS = 2, SLOPE = 3, KERNEL = 4;

void main()
{
    Receiver r;
    bool receives = receiver_at(ivec2(gl_FragCoord.xy), r);
    MapPoint m = map_point(r.point);
    bool sampled = receives && m.layer >= 0;
    int kernel = int(PARAM(KERNEL)), reach = kernel / 2, last = int(map_counts.y) - 1;
    float depth = m.depth - map_bias(r, m, PARAM(BIAS), PARAM(SLOPE)), sum = 0.0;
    for (int y = -reach; y <= (sampled ? reach : -reach - 1); y++)
        for (int x = -reach; x <= reach; x++)
            sum += map_lit(m, clamp(ivec2(m.texel) + ivec2(x, y), ivec2(0), ivec2(last)), depth);
    visibility = !receives ? 0.0 : m.layer < 0 ? 1.0 : sum / float(kernel * kernel);
}
