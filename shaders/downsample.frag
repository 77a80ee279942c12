/* The mean of aa x aa samples, in linear light; then as shown. */
#include "blocks.h"
#include "tonemap.glsl"

layout(binding = UNIT_PICTURE) uniform sampler2D samples;
layout(location = 0) out vec4 color;

void main()
{
    int n = int(picture.z);
    ivec2 first = ivec2(gl_FragCoord.xy) * n;
    vec3 sum = vec3(0);
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++)
            sum += texelFetch(samples, first + ivec2(x, y), 0).rgb;
    color = vec4(display_color(sum / float(n * n)), 1);
}
