/* Receivers from ids: the exact plane of the triangle, not the rasterizer's snapped depth (GL snaps vertices to 1/256 pixel). */
#include "scene_fetch.glsl"

layout(binding = UNIT_IDS) uniform usampler2D ids;
layout(location = 0) out vec4 receiver;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint id = texelFetch(ids, pixel, 0).x;
    receiver = vec4(0);
    for (int once = 0; once < (id != NO_TRIANGLE ? 1 : 0); once++) {
        Triangle t = triangle_at(id);
        vec3 origin, direction;
        view_pixel_ray(pixel, origin, direction);
        vec3 normal = cross(t.b - t.a, t.c - t.a);
        float facing = dot(normal, direction);
        float depth = dot(normal, t.a - origin) / facing;
        receiver = vec4(normalize(facing > 0.0 ? -normal : normal), depth);
    }
}
