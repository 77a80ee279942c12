/* Williams 1978: lit if no farther from the light than the nearest surface in the map. */
#include "maps.glsl"
#include "params.glsl"

layout(location = 0) out float visibility;

const int BIAS = 2, SLOPE = 3;

void main()
{
    Receiver r;
    bool receives = receiver_at(ivec2(gl_FragCoord.xy), r);
    MapPoint m = map_point(r.point);
    float lit = map_lit(m, ivec2(m.texel), m.depth - map_bias(r, m, PARAM(BIAS), PARAM(SLOPE)));
    visibility = !receives ? 0.0 : m.layer < 0 ? 1.0 : lit;
}
