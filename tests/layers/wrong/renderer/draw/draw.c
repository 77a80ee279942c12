#include "gl/texture.h"
#include "shadow/shadow.h"
static const char *vertex = "void main() { gl_Position = vec4(0); }";
