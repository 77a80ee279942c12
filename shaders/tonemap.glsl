/* ACES filmic curve, Krzysztof Narkowicz' fit (2015); then sRGB's own transfer function (IEC 61966-2-1). */
vec3 tonemap_aces(vec3 x) { return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }

vec3 srgb_from_linear(vec3 x)
{
    x = clamp(x, 0.0, 1.0);
    return mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, vec3(lessThanEqual(x, vec3(0.0031308))));
}

vec3 linear_from_srgb(vec3 x)
{
    return mix(pow((x + 0.055) / 1.055, vec3(2.4)), x / 12.92, vec3(lessThanEqual(x, vec3(0.04045))));
}

/* DISPLAY: 0 linear, 1 sRGB without a curve, 2 ACES and sRGB. */
vec3 display_color(vec3 c)
{
    if (DISPLAY == 2)
        c = tonemap_aces(c);
    return DISPLAY > 0 ? srgb_from_linear(c) : c;
}
