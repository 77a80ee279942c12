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
    float n_l = max(dot(s.normal, l), 0.0), n_e = max(abs(dot(s.normal, s.to_eye)), 1e-4);
    /* The half vector h = l + e needs no normalizing: |h|^2 = 2 + 2 l.e, and e.h / |h| = |h| / 2. */
    float h2 = max(2.0 + 2.0 * dot(l, s.to_eye), 1e-6), n_h = n_l + dot(s.normal, s.to_eye), n_h2 = n_h * n_h / h2;
    float alpha = max(s.roughness * s.roughness, 1e-3), a2 = alpha * alpha;
    float f = n_h2 * (a2 - 1.0) + 1.0;
    float smith = n_l * sqrt(n_e * n_e * (1.0 - a2) + a2) + n_e * sqrt(n_l * n_l * (1.0 - a2) + a2);
    float specular = a2 / (2.0 * PI * f * f * smith + 1e-7);
    vec3 f0 = mix(vec3(0.04), s.base_color, s.metallic);
    float m = max(1.0 - 0.5 * sqrt(h2), 0.0), m2 = m * m;
    vec3 fresnel = f0 + (1.0 - f0) * (m2 * m2 * m);
    vec3 diffuse = s.base_color * ((1.0 - s.metallic) / PI);
    return mix(diffuse, vec3(specular), fresnel) * n_l;
}
