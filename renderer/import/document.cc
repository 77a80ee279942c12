#include "import/document.hh"

#include <cstring>

#include "import/failure.hh"
#include "import/rules.hh"
#include "import/tinygltf.hh"
#include "import/warnings.hh"

namespace gltf
{
namespace
{

const char *const supported[] = {
    "KHR_texture_transform", "KHR_mesh_quantization",   "KHR_materials_unlit", "KHR_materials_emissive_strength",
    "KHR_lights_punctual",   "EXT_mesh_gpu_instancing", "EXT_texture_webp"};

bool is_supported(const std::string &name)
{
    for (const char *s : supported)
        if (name == s)
            return true;
    return false;
}

void check_extensions(const json &root, warnings &warn)
{
    std::string list;
    for (const char *s : supported)
        list += std::string(list.empty() ? "" : ", ") + s;
    for (const json &name : root.value("extensionsRequired", json::array()))
        if (!is_supported(name.get<std::string>()))
            fail("the file requires the extension %.80s, which is not supported; supported are %s",
                 name.get<std::string>().c_str(), list.c_str());
    for (const json &name : root.value("extensionsUsed", json::array()))
        if (!is_supported(name.get<std::string>()))
            warn.add("the extension %.80s was ignored", name.get<std::string>().c_str());
}

bool parse_version(const std::string &text, int *major, int *minor)
{
    int used = 0;
    return sscanf(text.c_str(), "%5d.%5d%n", major, minor, &used) == 2 && static_cast<size_t>(used) == text.size() &&
           *major >= 0 && *minor >= 0;
}

void check_version(const json &asset)
{
    int major, minor;
    std::string version = asset.at("version").get<std::string>(), least = asset.value("minVersion", std::string("2.0"));
    if (!parse_version(version, &major, &minor) || major != 2)
        fail("asset.version is \"%.40s\", only 2.x is accepted", version.c_str());
    if (!parse_version(least, &major, &minor) || major != 2 || minor > 0)
        fail("asset.minVersion is \"%.40s\", only 2.0 is accepted", least.c_str());
}

std::vector<resource> take_resources(json &root, const char *name)
{
    std::vector<resource> out;
    auto found = root.find(name);
    if (found == root.end())
        return out;
    for (json &entry : *found) {
        resource r;
        r.has_uri = entry.contains("uri");
        if (r.has_uri)
            r.uri = std::move(entry["uri"].get_ref<std::string &>());
        r.mime = entry.value("mimeType", std::string());
        r.byte_length = entry.value("byteLength", uint64_t{0});
        r.buffer_view = entry.value("bufferView", -1);
        out.push_back(std::move(r));
    }
    root.erase(found);
    return out;
}

/* A compressed primitive without an uncompressed copy has accessors that lead nowhere, even if the file forgets to say that it requires
 * the extension. */
void check_compression(const json &root)
{
    const char *const draco = "KHR_draco_mesh_compression";
    for (const json &mesh : root.value("meshes", json::array())) {
        for (const json &primitive : mesh.at("primitives")) {
            const json &attributes = primitive.at("attributes");
            if (!attributes.contains("POSITION") || !primitive.contains("extensions") || !primitive["extensions"].contains(draco))
                continue;
            const json &accessor = root.at("accessors").at(attributes["POSITION"].get<size_t>());
            if (!accessor.contains("bufferView") && !accessor.contains("sparse"))
                fail("the file requires the extension %s, which is not supported", draco);
        }
    }
}

/* tinygltf ends its sentences with line breaks. */
std::string one_line(std::string text)
{
    while (!text.empty() && (text.back() == '\n' || text.back() == '.' || text.back() == ' '))
        text.pop_back();
    return text;
}

bool refuse_exists(const std::string &, void *) { return false; }
std::string refuse_expand(const std::string &path, void *) { return path; }
bool refuse_read(std::vector<unsigned char> *, std::string *, const std::string &, void *) { return false; }
bool refuse_write(std::string *, const std::string &, const std::vector<unsigned char> &, void *) { return false; }

void parse_model(const json &root, tinygltf::Model &model)
{
    tinygltf::TinyGLTF parser;
    parser.SetFsCallbacks({refuse_exists, refuse_expand, refuse_read, refuse_write, nullptr});
    std::string text = root.dump(), error, warning;
    if (!parser.LoadASCIIFromString(&model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), ""))
        fail("the file is not valid glTF: %.300s", one_line(error).c_str());
}

} // namespace

document::document() : model(new tinygltf::Model) {}
document::~document() = default;

void read_document(span text, document &out, warnings &warn)
{
    json root = parse_json(text);
    if (root.is_object() && root.contains("asset") && root["asset"].is_object() && root["asset"].contains("version") &&
        root["asset"]["version"].is_string())
        check_version(root["asset"]);
    check_rules(root);
    check_extensions(root, warn);
    check_compression(root);
    out.buffers = take_resources(root, "buffers");
    out.images = take_resources(root, "images");
    out.skin_count = root.value("skins", json::array()).size();
    if (root.contains("animations"))
        warn.add("animations were ignored: the scene is drawn as its nodes stand");
    if (out.skin_count)
        warn.add("skins were ignored: skinned meshes are drawn in their bind pose");
    root.erase("animations");
    root.erase("skins");
    root.erase("extras");
    parse_model(root, *out.model);
}

} // namespace gltf
