/* The scene as a view sees it: for the camera's id buffer and for depth maps. HOLES: with texture coordinates. */
#include "blocks.h"

layout(location = 0) in vec3 position;
layout(location = 1) in uint instance;

layout(binding = UNIT_INSTANCES) uniform usamplerBuffer instances;
layout(binding = UNIT_ROWS) uniform samplerBuffer rows;

flat out uint first_triangle;

#ifdef HOLES
layout(binding = UNIT_TEXCOORDS) uniform samplerBuffer texcoord_texels;
layout(binding = UNIT_COLORS) uniform samplerBuffer color_texels;
flat out int material;
out vec4 texcoords;
out float vertex_alpha;
#endif

void main()
{
    uvec4 info = texelFetch(instances, int(instance));
    int row = int(instance) * 3;
    vec4 p1 = vec4(position, 1);
    vec3 p = vec3(dot(texelFetch(rows, row), p1), dot(texelFetch(rows, row + 1), p1), dot(texelFetch(rows, row + 2), p1));
    gl_Position = clip_from_relative * vec4(p, 1);
    first_triangle = info.x;
#ifdef FAR
    gl_ClipDistance[0] = draw_far.x - dot(draw_far.yzw, p);
#endif
#ifdef HOLES
    material = int(info.z);
    texcoords = HAS_TEXCOORDS != 0 ? texelFetch(texcoord_texels, gl_VertexID) : vec4(0);
    vertex_alpha = HAS_COLORS != 0 ? texelFetch(color_texels, gl_VertexID).w : 1.0;
#endif
}
