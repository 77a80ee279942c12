/* The other two passes of `soft`: a Gaussian along x (AXIS 0) and then y (AXIS 1), over the receiver's own surface only: a tap that lies off its
 * plane, as far as the distance allows, does not count. */
#include "pixel.glsl"
#include "soft_term.glsl"

#if AXIS == 0
layout(location = 0) out uint term;
#else
layout(location = 0) out float visibility;
#endif

layout(binding = UNIT_PIXELS) uniform usampler2D pixels;
layout(binding = UNIT_SOFT_TERM) uniform usampler2D terms;
layout(binding = UNIT_SOFT_RADIUS) uniform usampler2D radii;

const int TAPS = 6;         /* a side, at most */
const float WIDTH = 2.5;     /* standard deviations a side */
const float BEND = 0.25;     /* by how much the surface may leave its plane, of the distance */
const float FLAT_PIXELS = 2.0; /* and anywhere */

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint own = texelFetch(terms, pixel, 0).x;
    float guide = term_guide(own);
    float sigma = unpackHalf2x16(texelFetch(radii, pixel, 0).x)[AXIS];
    vec3 origin, d, n = octahedral_raw(unpackSnorm2x16(texelFetch(pixels, pixel, 0).x));
    pixel_ray(pixel, origin, d);
    bool parallel = view_clip.z != 0.0;
    float n_d = dot(n, d);
    float slope = parallel ? -dot(n, AXIS == 0 ? ray_origin_dx.xyz : ray_origin_dy.xyz) / n_d
                           : guide * dot(n, AXIS == 0 ? ray_direction_dx.xyz : ray_direction_dy.xyz) / n_d;
    /* A pixel's size, relative to the depth in perspective. */
    float grain = view_forward.w * (parallel ? 1.0 : guide);
    int side_taps = guide > 0.0 ? min(int(ceil(WIDTH * sigma)), TAPS) : 0;
    float stride = max(WIDTH * sigma / float(max(side_taps, 1)), 1.0), falloff = -0.72134752 / max(sigma * sigma, 1e-6);
    float last = float(soft_size[AXIS]) - 1.0, here = float(pixel[AXIS]);
    float sum = term_value(own), total = 1.0;
    for (int i = 0; i < 2 * side_taps; i++) {
        float offset = floor(float((i >> 1) + 1) * stride + 0.5) * ((i & 1) != 0 ? -1.0 : 1.0);
        float at = clamp(here + offset, 0.0, last);
        uint tap = texelFetch(terms, AXIS == 0 ? ivec2(at, pixel.y) : ivec2(pixel.x, at), 0).x;
        offset = at - here;
        float off_plane = abs(term_guide(tap) - guide - slope * offset);
        float w = off_plane <= grain * (FLAT_PIXELS + BEND * abs(offset)) && term_guide(tap) != 0.0 ? exp2(falloff * offset * offset) : 0.0;
        sum += w * term_value(tap);
        total += w;
    }
    float lit = sum / total;
#if AXIS == 0
    term = term_pack(lit, guide);
#else
    visibility = guide != 0.0 ? lit : 0.0;
#endif
}
