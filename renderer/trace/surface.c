#include "trace/surface.h"

#include <stdlib.h>
#include <string.h>

#define INLINE static inline __attribute__((always_inline))

/* The cofactor matrix takes normals along whatever the scale. Scaled to its largest entry, so that fp32 does not under- or overflow. */
static void fill_cofactor(const struct affine *a, float out[3][3])
{
    double c[3][3], most = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c[i][j] = a->linear[i1][j1] * a->linear[i2][j2] - a->linear[i1][j2] * a->linear[i2][j1];
            most = fmax(most, fabs(c[i][j]));
        }
    for (int i = 0; i < 9; i++)
        out[i / 3][i % 3] = (float)(c[i / 3][i % 3] / (most > 0 ? most : 1));
}

struct surface *surfaces_create(const struct scene *scene)
{
    struct surface *all = calloc(scene->instance_count + 1, sizeof *all);
    for (size_t i = 0; all && i < scene->instance_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct mesh *mesh = &scene->meshes[instance->mesh];
        const struct material *m = &scene->materials[mesh->material];
        struct surface *s = &all[i];
        s->normals = (const float(*)[3])scene->normals + mesh->first_vertex;
        s->colors = mesh->first_color == SCENE_NONE ? NULL : (const float(*)[4])scene->colors + mesh->first_color;
        s->indices = scene->indices + mesh->first_index;
        fill_cofactor(&instance->to_scene, s->cofactor);
        memcpy(s->base_color, m->base_color, sizeof s->base_color);
        s->roughness = m->roughness;
        s->metallic = pixel_unorm8(m->metallic);
        s->color = pixel_pack_color(m->base_color, m->roughness);
    }
    return all;
}

INLINE uint32_t mixed_color(const struct surface *s, const uint32_t corner[3], const float weight[3])
{
    float rgb[3];
    for (int k = 0; k < 3; k++)
        rgb[k] = s->base_color[k] * (s->colors[corner[0]][k] * weight[0] + s->colors[corner[1]][k] * weight[1] +
                                     s->colors[corner[2]][k] * weight[2]);
    return pixel_pack_color(rgb, s->roughness);
}

/* Sixteen hits, a member at a time, so that compilers see vectors. */
struct lanes {
    float normal[3][LANES];    /* shading; not unit */
    float geometric[3][LANES]; /* not unit; turned to the eye */
    uint32_t metallic[LANES], color[LANES];
    float depth[LANES];
};

INLINE void gather(const struct surface *surfaces, const struct RTCHit16 *hit, struct lanes *out)
{
    for (int i = 0; i < LANES; i++) {
        bool none = hit->geomID[i] == RTC_INVALID_GEOMETRY_ID;
        const struct surface *s = &surfaces[none ? 0 : hit->geomID[i]];
        if (none || !s->indices) {
            for (int k = 0; k < 3; k++)
                out->normal[k][i] = 0;
            out->metallic[i] = out->color[i] = 0;
            continue;
        }
        const uint32_t *corner = s->indices + 3 * (size_t)hit->primID[i];
        const float *a = s->normals[corner[0]], *b = s->normals[corner[1]], *c = s->normals[corner[2]];
        float weight[3] = {1 - hit->u[i] - hit->v[i], hit->u[i], hit->v[i]}, local[3];
        for (int k = 0; k < 3; k++)
            local[k] = a[k] * weight[0] + b[k] * weight[1] + c[k] * weight[2];
        for (int k = 0; k < 3; k++)
            out->normal[k][i] = s->cofactor[k][0] * local[0] + s->cofactor[k][1] * local[1] + s->cofactor[k][2] * local[2];
        out->metallic[i] = s->metallic;
        out->color[i] = s->colors ? mixed_color(s, corner, weight) : s->color;
    }
}

/* Geometric normals to the eye's side, shading normals to theirs; a shading normal that is none becomes the geometric one. */
INLINE void orient(const struct RTCHit16 *hit, const float facing[LANES], struct lanes *lanes)
{
    for (int i = 0; i < LANES; i++) {
        float x = hit->Ng_x[i], y = hit->Ng_y[i], z = hit->Ng_z[i];
        /* By the sum of components: a small triangle's normal underflows when squared. */
        float scale = (facing[i] > 0 ? -1.0f : 1.0f) / (fabsf(x) + fabsf(y) + fabsf(z));
        x *= scale, y *= scale, z *= scale;
        float nx = lanes->normal[0][i], ny = lanes->normal[1][i], nz = lanes->normal[2][i];
        bool none = !(fabsf(nx) + fabsf(ny) + fabsf(nz) > 0);
        nx = none ? x : nx, ny = none ? y : ny, nz = none ? z : nz;
        float side = nx * x + ny * y + nz * z < 0 ? -1.0f : 1.0f;
        lanes->geometric[0][i] = x, lanes->geometric[1][i] = y, lanes->geometric[2][i] = z;
        lanes->normal[0][i] = nx * side, lanes->normal[1][i] = ny * side, lanes->normal[2][i] = nz * side;
    }
}

INLINE void pack(const struct lanes *l, const struct RTCHit16 *hit, struct pixel out[LANES])
{
    uint32_t geometric[LANES], shading[LANES];
    for (int i = 0; i < LANES; i++)
        geometric[i] = pixel_pack_geometric(l->geometric[0][i], l->geometric[1][i], l->geometric[2][i]);
    for (int i = 0; i < LANES; i++)
        shading[i] = pixel_pack_shading(l->normal[0][i], l->normal[1][i], l->normal[2][i], l->metallic[i]);
    for (int i = 0; i < LANES; i++) {
        struct pixel p = {geometric[i], l->depth[i], shading[i], l->color[i]};
        out[i] = hit->geomID[i] == RTC_INVALID_GEOMETRY_ID ? (struct pixel){0} : p;
    }
}

INLINE void fill_pixels(const struct surface *surfaces, const struct RTCRayHit16 *packet, const float facing[LANES], float start,
                        struct pixel out[LANES])
{
    struct lanes lanes;
    gather(surfaces, &packet->hit, &lanes);
    orient(&packet->hit, facing, &lanes);
    for (int i = 0; i < LANES; i++)
        lanes.depth[i] = start + packet->ray.tfar[i];
    pack(&lanes, &packet->hit, out);
}

#ifdef __x86_64__
/* The same arithmetic (no contraction, CMakeLists.txt), so the same bits; about a millisecond less for 1280 x 720. */
__attribute__((target("avx2"))) static void fill_pixels_avx2(const struct surface *surfaces, const struct RTCRayHit16 *packet,
                                                             const float facing[LANES], float start, struct pixel out[LANES])
{
    fill_pixels(surfaces, packet, facing, start, out);
}
#endif

bool surface_pixels(const struct surface *surfaces, const struct RTCRayHit16 *packet, const float facing[LANES], float start,
                    struct pixel out[LANES])
{
    bool any = false;
    for (int i = 0; i < LANES; i++)
        any |= packet->hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    if (!any) {
        memset(out, 0, LANES * sizeof *out);
        return false;
    }
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        fill_pixels_avx2(surfaces, packet, facing, start, out);
        return true;
    }
#endif
    fill_pixels(surfaces, packet, facing, start, out);
    return true;
}
