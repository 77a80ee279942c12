#include <cmath>

#include "import/build.hh"
#include "import/failure.hh"

namespace gltf
{
namespace
{

enum wrap_mode wrap_from(int value, const char *name, size_t index)
{
    switch (value) {
    case 10497: return WRAP_REPEAT;
    case 33071: return WRAP_CLAMP_TO_EDGE;
    case 33648: return WRAP_MIRRORED_REPEAT;
    default: fail("samplers[%zu].%s is %d, accepted are 10497, 33071 and 33648", index, name, value);
    }
}

const tinygltf::Value *find(const tinygltf::ExtensionMap &extensions, const char *name)
{
    auto found = extensions.find(name);
    return found == extensions.end() ? nullptr : &found->second;
}

double number(const tinygltf::Value &object, const char *name, double otherwise)
{
    const tinygltf::Value &value = object.Get(name);
    return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

double entry(const tinygltf::Value &object, const char *name, size_t index, double otherwise)
{
    const tinygltf::Value &value = object.Get(name);
    return value.IsArray() && index < value.ArrayLen() ? value.Get(index).GetNumberAsDouble() : otherwise;
}

void add_texture(build &b, size_t index)
{
    const tinygltf::Texture &from = b.model.textures[index];
    struct texture texture = {};
    int source = from.source;
    if (const tinygltf::Value *webp = find(from.extensions, "EXT_texture_webp"))
        source = static_cast<int>(number(*webp, "source", source));
    uint32_t image = source < 0 ? SCENE_NONE : b.image_of[static_cast<size_t>(source)];
    if (image == SCENE_NONE) {
        b.warn.add("textures[%zu] has no image that can be read and was left out", index);
        b.texture_of.push_back(SCENE_NONE);
        return;
    }
    texture.image = image;
    if (from.sampler >= 0) {
        size_t s = static_cast<size_t>(from.sampler);
        texture.wrap_s = wrap_from(b.model.samplers[s].wrapS, "wrapS", s);
        texture.wrap_t = wrap_from(b.model.samplers[s].wrapT, "wrapT", s);
        texture.nearest = b.model.samplers[s].magFilter == 9728;
    }
    b.texture_of.push_back(static_cast<uint32_t>(b.textures.size()));
    b.textures.push(texture);
}

/* KHR_texture_transform: offset after rotation (counter-clockwise in the picture, so clockwise in u, v) after scale. */
void set_transform(struct texture_use *use, const tinygltf::Value &t)
{
    double angle = number(t, "rotation", 0), c = std::cos(angle), s = std::sin(angle);
    double sx = entry(t, "scale", 0, 1), sy = entry(t, "scale", 1, 1);
    const double rows[2][3] = {{c * sx, s * sy, entry(t, "offset", 0, 0)}, {-s * sx, c * sy, entry(t, "offset", 1, 0)}};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            use->transform[i][k] = static_cast<float>(rows[i][k]);
}

template <typename info> struct texture_use use_texture(build &b, const info &from, const char *name, size_t material)
{
    struct texture_use use = {SCENE_NONE, 0, {{1, 0, 0}, {0, 1, 0}}};
    if (from.index < 0)
        return use;
    int texcoord = from.texCoord;
    if (const tinygltf::Value *transform = find(from.extensions, "KHR_texture_transform")) {
        set_transform(&use, *transform);
        texcoord = static_cast<int>(number(*transform, "texCoord", texcoord));
    }
    if (texcoord > 1) {
        b.warn.add("materials[%zu].%s uses texture coordinates %d and was left out: sets 0 and 1 are read", material, name,
                   texcoord);
        return use;
    }
    use.texcoord = static_cast<uint32_t>(texcoord);
    use.texture = b.texture_of[static_cast<size_t>(from.index)];
    return use;
}

enum alpha_mode alpha_mode_from(const std::string &name, size_t index)
{
    if (name == "OPAQUE")
        return ALPHA_OPAQUE;
    if (name == "MASK")
        return ALPHA_MASK;
    if (name == "BLEND")
        return ALPHA_BLEND;
    fail("materials[%zu].alphaMode is \"%.40s\", accepted are OPAQUE, MASK and BLEND", index, name.c_str());
}

struct material plain_material(void)
{
    struct material m = {};
    const struct texture_use none = {SCENE_NONE, 0, {{1, 0, 0}, {0, 1, 0}}};
    for (float &c : m.base_color)
        c = 1;
    m.metallic = m.roughness = m.normal_scale = m.occlusion_strength = 1;
    m.alpha_cutoff = 0.5f;
    m.base_color_texture = m.metallic_roughness_texture = m.normal_texture = m.occlusion_texture = m.emissive_texture = none;
    return m;
}

void set_factors(struct material *m, const tinygltf::Material &from)
{
    const tinygltf::PbrMetallicRoughness &pbr = from.pbrMetallicRoughness;
    for (size_t k = 0; k < 4 && k < pbr.baseColorFactor.size(); k++)
        m->base_color[k] = static_cast<float>(pbr.baseColorFactor[k]);
    m->metallic = static_cast<float>(pbr.metallicFactor);
    m->roughness = static_cast<float>(pbr.roughnessFactor);
    double strength = 1;
    if (const tinygltf::Value *emissive = find(from.extensions, "KHR_materials_emissive_strength"))
        strength = number(*emissive, "emissiveStrength", 1);
    for (size_t k = 0; k < 3 && k < from.emissiveFactor.size(); k++) {
        m->emissive[k] = static_cast<float>(from.emissiveFactor[k] * strength);
        if (!std::isfinite(m->emissive[k]))
            fail("the emissive factor of material \"%.60s\" times its strength is too large", from.name.c_str());
    }
    m->normal_scale = static_cast<float>(from.normalTexture.scale);
    m->occlusion_strength = static_cast<float>(from.occlusionTexture.strength);
}

void add_material(build &b, size_t index)
{
    const tinygltf::Material &from = b.model.materials[index];
    struct material m = plain_material();
    copy_name(m.name, sizeof m.name, from.name);
    set_factors(&m, from);
    m.alpha_mode = alpha_mode_from(from.alphaMode, index);
    m.alpha_cutoff = m.alpha_mode == ALPHA_MASK ? static_cast<float>(from.alphaCutoff) : 0.5f;
    m.double_sided = from.doubleSided;
    m.unlit = find(from.extensions, "KHR_materials_unlit") != nullptr;
    m.base_color_texture = use_texture(b, from.pbrMetallicRoughness.baseColorTexture, "baseColorTexture", index);
    m.metallic_roughness_texture =
        use_texture(b, from.pbrMetallicRoughness.metallicRoughnessTexture, "metallicRoughnessTexture", index);
    m.normal_texture = use_texture(b, from.normalTexture, "normalTexture", index);
    m.occlusion_texture = use_texture(b, from.occlusionTexture, "occlusionTexture", index);
    m.emissive_texture = use_texture(b, from.emissiveTexture, "emissiveTexture", index);
    b.materials.push(m);
}

} // namespace

/* The last one is glTF's default material (3.7.2.1), for primitives without. */
void build_materials(build &b)
{
    for (size_t i = 0; i < b.model.textures.size(); i++)
        add_texture(b, i);
    for (size_t i = 0; i < b.model.materials.size(); i++)
        add_material(b, i);
    struct material last = plain_material();
    copy_name(last.name, sizeof last.name, "default");
    b.materials.push(last);
}

} // namespace gltf
