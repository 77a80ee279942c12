/* The mean of aa x aa samples, in linear light; then as shown, over the background. */
#include "blocks.h"
#include "tonemap.glsl"

layout(binding = UNIT_PICTURE) uniform sampler2D samples;
layout(location = 0) out vec4 color;

void main()
{
    int n = int(picture.z);
    ivec2 first = ivec2(gl_FragCoord.xy) * n;
    vec4 sum = vec4(0);
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++)
            sum += texelFetch(samples, first + ivec2(x, y), 0);
    color = vec4(mix(background.rgb, display_color(sum.rgb / max(sum.w, 1.0)), sum.w / float(n * n)), 1);
}
