/* Nearest and farthest of the depth texels round a block (shadow/depth/map_ranges.h). STEP 0: of the block's own BLOCK_SIDE x BLOCK_SIDE texels; 1: and of its
 * eight neighbours'. LAYER: the map. */
#include "blocks.h"

layout(location = 0) out vec2 range;

#if STEP == 0

layout(binding = UNIT_SHADOW_MAP) uniform sampler2DArray shadow_map;

void main()
{
    vec2 side = vec2(textureSize(shadow_map, 0).xy);
    ivec2 base = ivec2(gl_FragCoord.xy) * BLOCK_SIDE;
    vec4 high = vec4(0), low = vec4(1);
    for (int y = 1; y < BLOCK_SIDE; y += 2)
        for (int x = 1; x < BLOCK_SIDE; x += 2) {
            vec4 four = textureGather(shadow_map, vec3(vec2(base + ivec2(x, y)) / side, LAYER));
            high = max(high, four);
            low = min(low, four);
        }
    range = vec2(max(max(high.x, high.y), max(high.z, high.w)), min(min(low.x, low.y), min(low.z, low.w)));
}

#else

layout(binding = UNIT_MAP_RANGES) uniform sampler2DArray ranges;

void main()
{
    ivec2 last = textureSize(ranges, 0).xy - 1, at = ivec2(gl_FragCoord.xy);
    range = vec2(0, 1);
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++) {
            vec2 other = texelFetch(ranges, ivec3(clamp(at + ivec2(x, y), ivec2(0), last), LAYER), 0).xy;
            range = vec2(max(range.x, other.x), min(range.y, other.y));
        }
}

#endif
