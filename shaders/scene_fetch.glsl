/* Triangles of the scene by drawn-triangle id. */
#include "blocks.h"

layout(binding = UNIT_VERTICES) uniform usamplerBuffer vertices;
layout(binding = UNIT_TRIANGLES) uniform usamplerBuffer triangles;
layout(binding = UNIT_INSTANCES) uniform usamplerBuffer instances;
layout(binding = UNIT_ROWS) uniform samplerBuffer rows;

struct Triangle {
    uint instance, material;
    uvec3 vertex;
    vec3 a, b, c;    /* relative */
    uvec3 normal;    /* packed */
};

/* Last instance whose first triangle is at most id. */
uint instance_of(uint id)
{
    uint low = 0u, count = view_counts.x;
    for (uint step = 0u; step < view_counts.y; step++) {
        uint half_count = count >> 1;
        uint middle = low + half_count;
        if (half_count > 0u && texelFetch(instances, int(middle)).x <= id) {
            low = middle;
            count -= half_count;
        } else {
            count = max(half_count, 1u);
        }
    }
    return low;
}

Triangle triangle_at(uint id)
{
    Triangle t;
    t.instance = instance_of(id);
    uvec4 info = texelFetch(instances, int(t.instance));
    t.material = info.z;
    t.vertex = texelFetch(triangles, int(info.y + (id - info.x))).xyz;
    uvec4 a = texelFetch(vertices, int(t.vertex.x));
    uvec4 b = texelFetch(vertices, int(t.vertex.y));
    uvec4 c = texelFetch(vertices, int(t.vertex.z));
    int row = int(t.instance) * 3;
    vec4 r0 = texelFetch(rows, row), r1 = texelFetch(rows, row + 1), r2 = texelFetch(rows, row + 2);
    vec4 pa = vec4(uintBitsToFloat(a.xyz), 1), pb = vec4(uintBitsToFloat(b.xyz), 1), pc = vec4(uintBitsToFloat(c.xyz), 1);
    t.a = vec3(dot(r0, pa), dot(r1, pa), dot(r2, pa));
    t.b = vec3(dot(r0, pb), dot(r1, pb), dot(r2, pb));
    t.c = vec3(dot(r0, pc), dot(r1, pc), dot(r2, pc));
    t.normal = uvec3(a.w, b.w, c.w);
    return t;
}
