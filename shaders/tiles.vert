/* A rectangle of the picture, four vertices each (passes/tiles.h). */
layout(location = 0) in vec4 rectangle;

void main()
{
    gl_Position = vec4((gl_VertexID & 1) == 0 ? rectangle.x : rectangle.z, (gl_VertexID & 2) == 0 ? rectangle.y : rectangle.w, 0.5, 1.0);
}
