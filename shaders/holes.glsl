/* Holes: a triangle of a MASK (or BLEND) material is solid where the nearest texel of the base level, times the factors, reaches the
 * cutoff. The same rule as material_alpha() in C. */
layout(binding = UNIT_MATERIALS) uniform samplerBuffer materials;
layout(binding = UNIT_TEXTURES) uniform usamplerBuffer textures;
layout(binding = UNIT_TEXELS) uniform usamplerBuffer texels;

vec2 transformed_texcoord(int use_texel, vec4 texcoords)
{
    vec4 use0 = texelFetch(materials, use_texel), use1 = texelFetch(materials, use_texel + 1);
    vec2 uv = use0.y > 0.5 ? texcoords.zw : texcoords.xy;
    return vec2(dot(use1.xy, uv), dot(use1.zw, uv)) + use0.zw;
}

int wrap(int i, int size, uint mode)
{
    if (mode == 2u)
        return clamp(i, 0, size - 1);
    int period = mode == 1u ? 2 * size : size;
    /* A float quotient, since integer division is slow: GPUs may round it to the integer above or below, so the remainder is set right. */
    int m = i - period * int(floor(float(i) / float(period)));
    m += m < 0 ? period : m >= period ? -period : 0;
    return clamp(m < size ? m : period - 1 - m, 0, size - 1);
}

uint texel_at(uvec4 texture_info, ivec2 size, uint first, ivec2 at)
{
    at = ivec2(wrap(at.x, size.x, texture_info.z & 255u), wrap(at.y, size.y, (texture_info.z >> 8) & 255u));
    return texelFetch(texels, int(first) + at.y * size.x + at.x).x;
}

float base_alpha(int material, vec4 texcoords, float vertex_alpha)
{
    float alpha = texelFetch(materials, material * MATERIAL_TEXELS).w * vertex_alpha;
    float texture_index = texelFetch(materials, material * MATERIAL_TEXELS + MATERIAL_BASE_COLOR).x;
    if (texture_index < 0.0)
        return alpha;
    uvec4 info = texelFetch(textures, int(texture_index));
    ivec2 size = ivec2(info.y & 0xffffu, info.y >> 16);
    vec2 uv = transformed_texcoord(material * MATERIAL_TEXELS + MATERIAL_BASE_COLOR, texcoords);
    uint texel = texel_at(info, size, info.x, ivec2(floor(uv * vec2(size))));
    return alpha * float(texel >> 24) / 255.0;
}
