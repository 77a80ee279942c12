/* glTF 2.0 metallic-roughness, Appendix B.3: GGX distribution with Smith height-correlated visibility (Heitz 2014) and Schlick's Fresnel. */
const float PI = 3.14159265358979;

struct Lit {
    vec3 base_color;
    vec3 normal;  /* shading, unit */
    vec3 to_eye;  /* unit */
    float metallic, roughness;
};

/* Radiance sent to the eye for unit irradiance arriving from direction l at normal incidence. */
vec3 brdf_times_cosine(Lit s, vec3 l)
{
    float n_l = max(dot(s.normal, l), 0.0);
    vec3 h = normalize(l + s.to_eye);
    float n_v = max(abs(dot(s.normal, s.to_eye)), 1e-4), n_h = clamp(dot(s.normal, h), 0.0, 1.0);
    float v_h = clamp(dot(s.to_eye, h), 0.0, 1.0);
    float alpha = max(s.roughness * s.roughness, 1e-3), a2 = alpha * alpha;
    float f = (n_h * a2 - n_h) * n_h + 1.0;
    float distribution = a2 / (PI * f * f);
    float visible = 0.5 / (1e-7 + n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2));
    vec3 f0 = mix(vec3(0.04), s.base_color, s.metallic);
    float m = 1.0 - v_h, m2 = m * m;
    vec3 fresnel = f0 + (1.0 - f0) * (m2 * m2 * m);
    vec3 diffuse = s.base_color * ((1.0 - s.metallic) / PI);
    return mix(diffuse, vec3(distribution * visible), fresnel) * n_l;
}
