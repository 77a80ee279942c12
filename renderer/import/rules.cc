#include "import/rules.hh"

#include <cmath>
#include <string>

#include "import/failure.hh"

namespace gltf
{
namespace
{

enum class kind { boolean, string, number, integer, index, numbers, indices, strings, object, objects, index_map };

struct rule {
    const char *name;
    kind type;
    bool required = false;
    double min = -HUGE_VAL, max = HUGE_VAL; /* number, integer, each of numbers */
    size_t count = 0;                       /* numbers: how many, 0: any */
    const char *collection = nullptr;       /* index, indices, index_map: into this root array */
    const rule *members = nullptr;          /* object, objects */
};

constexpr double above_zero = 4.9406564584124654e-324, int_max = 2147483647.0, size_max = 9007199254740992.0;
constexpr size_t array_max = 1000000;
#define END                   \
    {                         \
        nullptr, kind::object \
    }

const rule texture_transform[] = {{"offset", kind::numbers, false, -HUGE_VAL, HUGE_VAL, 2},
                                  {"rotation", kind::number},
                                  {"scale", kind::numbers, false, -HUGE_VAL, HUGE_VAL, 2},
                                  {"texCoord", kind::integer, false, 0, int_max},
                                  END};
const rule texture_info_extensions[] = {{"KHR_texture_transform", kind::object, false, 0, 0, 0, nullptr, texture_transform}, END};
const rule texture_info[] = {{"index", kind::index, true, 0, 0, 0, "textures"},
                             {"texCoord", kind::integer, false, 0, int_max},
                             {"scale", kind::number},
                             {"strength", kind::number, false, 0, 1},
                             {"extensions", kind::object, false, 0, 0, 0, nullptr, texture_info_extensions},
                             END};
const rule metallic_roughness[] = {{"baseColorFactor", kind::numbers, false, 0, 1, 4},
                                   {"metallicFactor", kind::number, false, 0, 1},
                                   {"roughnessFactor", kind::number, false, 0, 1},
                                   {"baseColorTexture", kind::object, false, 0, 0, 0, nullptr, texture_info},
                                   {"metallicRoughnessTexture", kind::object, false, 0, 0, 0, nullptr, texture_info},
                                   END};
const rule emissive_strength[] = {{"emissiveStrength", kind::number, false, 0}, END};
const rule nothing[] = {END};
const rule material_extensions[] = {{"KHR_materials_emissive_strength", kind::object, false, 0, 0, 0, nullptr, emissive_strength},
                                    {"KHR_materials_unlit", kind::object, false, 0, 0, 0, nullptr, nothing},
                                    END};
const rule material[] = {{"name", kind::string},
                         {"pbrMetallicRoughness", kind::object, false, 0, 0, 0, nullptr, metallic_roughness},
                         {"normalTexture", kind::object, false, 0, 0, 0, nullptr, texture_info},
                         {"occlusionTexture", kind::object, false, 0, 0, 0, nullptr, texture_info},
                         {"emissiveTexture", kind::object, false, 0, 0, 0, nullptr, texture_info},
                         {"emissiveFactor", kind::numbers, false, 0, HUGE_VAL, 3},
                         {"alphaMode", kind::string},
                         {"alphaCutoff", kind::number, false, 0},
                         {"doubleSided", kind::boolean},
                         {"extensions", kind::object, false, 0, 0, 0, nullptr, material_extensions},
                         END};
const rule sparse_indices[] = {{"bufferView", kind::index, true, 0, 0, 0, "bufferViews"},
                               {"byteOffset", kind::integer, false, 0, int_max},
                               {"componentType", kind::integer, true, 5121, 5125},
                               END};
const rule sparse_values[] = {
    {"bufferView", kind::index, true, 0, 0, 0, "bufferViews"}, {"byteOffset", kind::integer, false, 0, int_max}, END};
const rule sparse[] = {{"count", kind::integer, true, 1, int_max},
                       {"indices", kind::object, true, 0, 0, 0, nullptr, sparse_indices},
                       {"values", kind::object, true, 0, 0, 0, nullptr, sparse_values},
                       END};
const rule accessor[] = {{"bufferView", kind::index, false, 0, 0, 0, "bufferViews"},
                         {"byteOffset", kind::integer, false, 0, size_max},
                         {"componentType", kind::integer, true, 5120, 5126},
                         {"normalized", kind::boolean},
                         {"count", kind::integer, true, 1, int_max},
                         {"type", kind::string, true},
                         {"min", kind::numbers},
                         {"max", kind::numbers},
                         {"sparse", kind::object, false, 0, 0, 0, nullptr, sparse},
                         END};
const rule buffer[] = {{"byteLength", kind::integer, true, 1, size_max}, {"uri", kind::string}, END};
const rule buffer_view[] = {{"buffer", kind::index, true, 0, 0, 0, "buffers"}, {"byteOffset", kind::integer, false, 0, size_max},
                            {"byteLength", kind::integer, true, 1, size_max},  {"byteStride", kind::integer, false, 4, 252},
                            {"target", kind::integer, false, 0, int_max},      END};
const rule image[] = {{"uri", kind::string},
                      {"mimeType", kind::string},
                      {"name", kind::string},
                      {"bufferView", kind::index, false, 0, 0, 0, "bufferViews"},
                      END};
const rule texture_webp[] = {{"source", kind::index, true, 0, 0, 0, "images"}, END};
const rule texture_extensions[] = {{"EXT_texture_webp", kind::object, false, 0, 0, 0, nullptr, texture_webp}, END};
const rule texture[] = {{"sampler", kind::index, false, 0, 0, 0, "samplers"},
                        {"source", kind::index, false, 0, 0, 0, "images"},
                        {"extensions", kind::object, false, 0, 0, 0, nullptr, texture_extensions},
                        END};
const rule sampler[] = {{"magFilter", kind::integer, false, 9728, 9729},
                        {"minFilter", kind::integer, false, 9728, 9987},
                        {"wrapS", kind::integer, false, 10497, 33648},
                        {"wrapT", kind::integer, false, 10497, 33648},
                        END};
const rule primitive[] = {{"attributes", kind::index_map, true, 0, 0, 0, "accessors"},
                          {"indices", kind::index, false, 0, 0, 0, "accessors"},
                          {"material", kind::index, false, 0, 0, 0, "materials"},
                          {"mode", kind::integer, false, 0, 6},
                          END};
const rule mesh[] = {{"name", kind::string}, {"primitives", kind::objects, true, 1, 0, 0, nullptr, primitive}, END};
const rule gpu_instancing[] = {{"attributes", kind::index_map, true, 0, 0, 0, "accessors"}, END};
const rule node_light[] = {{"light", kind::index, true, 0, 0, 0, "KHR_lights_punctual"}, END};
const rule node_extensions[] = {{"EXT_mesh_gpu_instancing", kind::object, false, 0, 0, 0, nullptr, gpu_instancing},
                                {"KHR_lights_punctual", kind::object, false, 0, 0, 0, nullptr, node_light},
                                END};
const rule node[] = {{"name", kind::string},
                     {"mesh", kind::index, false, 0, 0, 0, "meshes"},
                     {"camera", kind::index, false, 0, 0, 0, "cameras"},
                     {"skin", kind::index, false, 0, 0, 0, "skins"},
                     {"children", kind::indices, false, 0, 0, 0, "nodes"},
                     {"matrix", kind::numbers, false, -HUGE_VAL, HUGE_VAL, 16},
                     {"rotation", kind::numbers, false, -HUGE_VAL, HUGE_VAL, 4},
                     {"scale", kind::numbers, false, -HUGE_VAL, HUGE_VAL, 3},
                     {"translation", kind::numbers, false, -HUGE_VAL, HUGE_VAL, 3},
                     {"extensions", kind::object, false, 0, 0, 0, nullptr, node_extensions},
                     END};
const rule scene[] = {{"name", kind::string}, {"nodes", kind::indices, false, 0, 0, 0, "nodes"}, END};
const rule skin[] = {{"joints", kind::indices, true, 0, 0, 0, "nodes"},
                     {"skeleton", kind::index, false, 0, 0, 0, "nodes"},
                     {"inverseBindMatrices", kind::index, false, 0, 0, 0, "accessors"},
                     END};
const rule perspective[] = {{"yfov", kind::number, true, above_zero, 3.14159265358979},
                            {"znear", kind::number, true, above_zero},
                            {"zfar", kind::number, false, above_zero},
                            {"aspectRatio", kind::number, false, above_zero},
                            END};
const rule orthographic[] = {{"xmag", kind::number, true},
                             {"ymag", kind::number, true},
                             {"znear", kind::number, true, 0},
                             {"zfar", kind::number, true, above_zero},
                             END};
const rule camera[] = {{"name", kind::string},
                       {"type", kind::string, true},
                       {"perspective", kind::object, false, 0, 0, 0, nullptr, perspective},
                       {"orthographic", kind::object, false, 0, 0, 0, nullptr, orthographic},
                       END};
const rule spot[] = {{"innerConeAngle", kind::number, false, 0}, {"outerConeAngle", kind::number, false, above_zero}, END};
const rule light[] = {{"name", kind::string},
                      {"type", kind::string, true},
                      {"color", kind::numbers, false, 0, HUGE_VAL, 3},
                      {"intensity", kind::number, false, 0},
                      {"range", kind::number, false, above_zero},
                      {"spot", kind::object, false, 0, 0, 0, nullptr, spot},
                      END};
const rule lights_punctual[] = {{"lights", kind::objects, true, 0, 0, 0, nullptr, light}, END};
const rule root_extensions[] = {{"KHR_lights_punctual", kind::object, false, 0, 0, 0, nullptr, lights_punctual}, END};
const rule asset[] = {{"version", kind::string, true}, {"minVersion", kind::string}, END};
const rule root_members[] = {{"asset", kind::object, true, 0, 0, 0, nullptr, asset},
                             {"extensionsUsed", kind::strings},
                             {"extensionsRequired", kind::strings},
                             {"buffers", kind::objects, false, 0, 0, 0, nullptr, buffer},
                             {"bufferViews", kind::objects, false, 0, 0, 0, nullptr, buffer_view},
                             {"accessors", kind::objects, false, 0, 0, 0, nullptr, accessor},
                             {"images", kind::objects, false, 0, 0, 0, nullptr, image},
                             {"samplers", kind::objects, false, 0, 0, 0, nullptr, sampler},
                             {"textures", kind::objects, false, 0, 0, 0, nullptr, texture},
                             {"materials", kind::objects, false, 0, 0, 0, nullptr, material},
                             {"meshes", kind::objects, false, 0, 0, 0, nullptr, mesh},
                             {"skins", kind::objects, false, 0, 0, 0, nullptr, skin},
                             {"cameras", kind::objects, false, 0, 0, 0, nullptr, camera},
                             {"nodes", kind::objects, false, 0, 0, 0, nullptr, node},
                             {"scenes", kind::objects, false, 0, 0, 0, nullptr, scene},
                             {"scene", kind::index, false, 0, 0, 0, "scenes"},
                             {"animations", kind::objects, false, 0, 0, 0, nullptr, nothing},
                             {"extensions", kind::object, false, 0, 0, 0, nullptr, root_extensions},
                             END};

class checker
{
  public:
    explicit checker(const json &root) : root_(root) {}

    void object(json &value, const rule *rules, const std::string &path)
    {
        if (!value.is_object())
            fail("%s must be an object", path.empty() ? "the top level of the JSON" : path.c_str());
        for (const rule *r = rules; r->name; r++) {
            auto found = value.find(r->name);
            std::string where = path.empty() ? r->name : path + "." + r->name;
            if (found != value.end())
                member(*found, *r, where);
            else if (r->required)
                fail("%s is missing", where.c_str());
        }
    }

  private:
    size_t collection_size(const char *name) const
    {
        if (strcmp(name, "KHR_lights_punctual") == 0) {
            static const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
            return root_.contains(lights) ? root_.at(lights).size() : 0;
        }
        auto found = root_.find(name);
        return found != root_.end() && found->is_array() ? found->size() : 0;
    }

    void number(const json &value, const rule &r, const std::string &path) const
    {
        if (!value.is_number() || !std::isfinite(value.get<double>()))
            fail("%s must be a number", path.c_str());
        double x = value.get<double>();
        if (r.min == above_zero && !(x > 0))
            fail("%s is %g, it must be greater than 0", path.c_str(), x);
        if (x < r.min || x > r.max)
            fail("%s is %g, accepted are %g to %g", path.c_str(), x, r.min, r.max);
    }

    void integer(json &value, const rule &r, const std::string &path) const
    {
        if (value.is_number_float()) {
            double x = value.get<double>();
            if (std::isfinite(x) && x == std::floor(x) && std::fabs(x) <= size_max)
                value = static_cast<int64_t>(x);
        }
        if (value.is_number_integer() && !value.is_number_unsigned() && value.get<int64_t>() >= 0)
            value = static_cast<uint64_t>(value.get<int64_t>());
        if (!value.is_number_integer())
            fail("%s must be a whole number", path.c_str());
        double x = value.get<double>();
        if (x < r.min || x > r.max)
            fail("%s is %.17g, accepted are %.17g to %.17g", path.c_str(), x, r.min, r.max);
    }

    void index(json &value, const rule &r, const std::string &path) const
    {
        size_t size = collection_size(r.collection);
        rule whole = {r.name, kind::integer};
        integer(value, whole, path);
        double x = value.get<double>();
        if (x < 0 || x >= static_cast<double>(size))
            fail("%s names entry %.17g of %s, which has %zu", path.c_str(), x, r.collection, size);
    }

    template <typename each> void array(json &value, const std::string &path, each check) const
    {
        if (!value.is_array())
            fail("%s must be an array", path.c_str());
        if (value.size() > array_max)
            fail("%s has %zu entries, at most %zu are accepted", path.c_str(), value.size(), array_max);
        for (size_t i = 0; i < value.size(); i++)
            check(value[i], path + "[" + std::to_string(i) + "]");
    }

    void numbers(json &value, const rule &r, const std::string &path) const
    {
        array(value, path, [&](json &entry, const std::string &where) { number(entry, r, where); });
        if (r.count && value.size() != r.count)
            fail("%s has %zu numbers, it must have %zu", path.c_str(), value.size(), r.count);
    }

    void index_map(json &value, const rule &r, const std::string &path) const
    {
        if (!value.is_object())
            fail("%s must be an object", path.c_str());
        for (auto entry = value.begin(); entry != value.end(); ++entry)
            index(entry.value(), r, path + "." + entry.key().substr(0, 40));
    }

    void objects(json &value, const rule &r, const std::string &path)
    {
        array(value, path, [&](json &entry, const std::string &where) { object(entry, r.members, where); });
        if (static_cast<double>(value.size()) < r.min)
            fail("%s must not be empty", path.c_str());
    }

    void member(json &value, const rule &r, const std::string &path)
    {
        switch (r.type) {
        case kind::boolean:
            if (!value.is_boolean())
                fail("%s must be true or false", path.c_str());
            break;
        case kind::string:
            if (!value.is_string())
                fail("%s must be a string", path.c_str());
            break;
        case kind::number: number(value, r, path); break;
        case kind::integer: integer(value, r, path); break;
        case kind::index: index(value, r, path); break;
        case kind::numbers: numbers(value, r, path); break;
        case kind::indices: array(value, path, [&](json &entry, const std::string &where) { index(entry, r, where); }); break;
        case kind::strings:
            array(value, path, [&](json &entry, const std::string &where) {
                if (!entry.is_string())
                    fail("%s must be a string", where.c_str());
            });
            break;
        case kind::object: object(value, r.members, path); break;
        case kind::objects: objects(value, r, path); break;
        case kind::index_map: index_map(value, r, path); break;
        }
    }

    const json &root_;
};

} // namespace

void check_rules(json &root) { checker(root).object(root, root_members, ""); }

} // namespace gltf
