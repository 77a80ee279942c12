/* IDS: writes the drawn-triangle id; else depth alone. HOLES: discards where the material has none of itself. */
#include "blocks.h"

flat in uint first_triangle;

#ifdef HOLES
#include "holes.glsl"
flat in int material;
in vec4 texcoords;
in float vertex_alpha;
#endif

#ifdef IDS
layout(location = 0) out uint id;
#endif

void main()
{
#ifdef HOLES
    float cutoff = texelFetch(materials, material * MATERIAL_TEXELS + 2).w;
    if (cutoff >= 0.0 && base_alpha(material, texcoords, vertex_alpha) < cutoff)
        discard;
#endif
#ifdef IDS
    id = first_triangle + uint(gl_PrimitiveID);
#endif
}
