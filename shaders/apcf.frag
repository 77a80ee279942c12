/* Zhang, Yang, Liu 2012, section 2.3: the four far corners of the template decide, or else its weighted mean does. TEMPLATE: its side in
 * texels; WEIGHTS: index of the choice. */
#include "maps.glsl"
#include "params.glsl"

layout(location = 0) out float visibility;

const int BIAS = 2, SLOPE = 3, UMBRA = 6;
const int REACH = TEMPLATE / 2;

/* 1 in the corners, rising to the middle (the paper's figure 2 is not in its text). */
float weight(ivec2 at)
{
    ivec2 from_edge = REACH + 1 - abs(at);
    return WEIGHTS == 0 ? float(from_edge.x * from_edge.y) : WEIGHTS == 1 ? float(from_edge.x + from_edge.y - 1) : 1.0;
}

void main()
{
    Receiver r;
    bool receives = receiver_at(ivec2(gl_FragCoord.xy), r);
    MapPoint m = map_point(r.point);
    float depth = m.depth - map_bias(r, m, PARAM(BIAS), PARAM(SLOPE));
    ivec2 center = ivec2(m.texel), last = ivec2(int(map_counts.y) - 1);
    ivec2 low = max(center - REACH, ivec2(0)), high = min(center + REACH, last);
    float corners = map_lit(m, low, depth) + map_lit(m, high, depth) + map_lit(m, ivec2(low.x, high.y), depth) +
                    map_lit(m, ivec2(high.x, low.y), depth);
    bool undecided = receives && m.layer >= 0 && corners > 0.0 && corners < 4.0;
    /* One loop with a small body: software rasterizers run a body once even where no lane wants it. */
    float sum = 0.0, total = 0.0;
    for (ivec2 at = ivec2(-REACH); at.y <= (undecided ? REACH : -REACH - 1); at = at.x < REACH ? ivec2(at.x + 1, at.y) : ivec2(-REACH, at.y + 1)) {
        float w = weight(at);
        sum += w * map_lit(m, clamp(center + at, ivec2(0), last), depth);
        total += w;
    }
    float lit = undecided ? sum / total : corners * 0.25;
    visibility = !receives ? 0.0 : m.layer < 0 ? 1.0 : mix(PARAM(UMBRA), 1.0, lit);
}
