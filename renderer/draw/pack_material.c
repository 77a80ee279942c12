#include "draw/pack_material.h"

#include <string.h>

static void pack_use(const struct texture_use *use, float out[2][4])
{
    bool none = use->texture == SCENE_NONE;
    float first[4] = {none ? -1.0f : (float)use->texture, (float)use->texcoord, use->transform[0][2], use->transform[1][2]};
    float second[4] = {use->transform[0][0], use->transform[0][1], use->transform[1][0], use->transform[1][1]};
    memcpy(out[0], first, sizeof first);
    memcpy(out[1], second, sizeof second);
}

void pack_material(const struct material *m, float out[MATERIAL_TEXELS][4])
{
    float factors[4] = {m->unlit ? -1.0f : m->metallic, m->roughness, m->normal_scale, m->occlusion_strength};
    float emissive[4] = {m->emissive[0], m->emissive[1], m->emissive[2], material_has_holes(m) ? m->alpha_cutoff : -1.0f};
    memcpy(out[0], m->base_color, sizeof out[0]);
    memcpy(out[1], factors, sizeof factors);
    memcpy(out[2], emissive, sizeof emissive);
    pack_use(&m->base_color_texture, out + MATERIAL_BASE_COLOR);
    pack_use(&m->metallic_roughness_texture, out + MATERIAL_METALLIC_ROUGHNESS);
    pack_use(&m->normal_texture, out + MATERIAL_NORMAL);
    pack_use(&m->occlusion_texture, out + MATERIAL_OCCLUSION);
    pack_use(&m->emissive_texture, out + MATERIAL_EMISSIVE);
}
