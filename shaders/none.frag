#include "receiver.glsl"

layout(location = 0) out float visibility;

void main()
{
    Receiver r;
    visibility = receiver_at(ivec2(gl_FragCoord.xy), r) ? 1.0 : 0.0;
}
