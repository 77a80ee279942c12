#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "import/build.hh"
#include "import/failure.hh"

namespace gltf
{
namespace
{

struct attribute_set {
    int position = -1, normal = -1, texcoord[2] = {-1, -1}, color = -1;
};

/* Vertices already stored: primitives that name the same accessors share them. Without normals every triangle has its own three, so indices
 * and mode count too. */
using vertex_key = std::array<int, 7>;
using mesh_key = std::array<int, 9>;

struct vertex_range {
    uint32_t first, count, texcoord[2], color;
    bool expanded; /* one vertex per index: indices are 0, 1, 2, ... */
};

struct mesh_builder {
    build &b;
    std::map<vertex_key, vertex_range> vertices;
    std::map<mesh_key, uint32_t> meshes;
};

bool is_normalized_unsigned(const tinygltf::Accessor &a)
{
    return a.normalized && (a.componentType == 5121 || a.componentType == 5123);
}

bool is_small_integer(const tinygltf::Accessor &a) { return a.componentType >= 5120 && a.componentType <= 5123; }

/* glTF 3.7.2.1 and KHR_mesh_quantization. */
bool format_accepted(const std::string &name, const tinygltf::Accessor &a, unsigned components)
{
    bool is_float = a.componentType == 5126;
    if (name == "POSITION")
        return components == 3 && (is_float || is_small_integer(a));
    if (name == "NORMAL")
        return components == 3 && (is_float || (a.normalized && (a.componentType == 5120 || a.componentType == 5122)));
    if (name == "COLOR_0")
        return (components == 3 || components == 4) && (is_float || is_normalized_unsigned(a));
    return components == 2 && (is_float || is_small_integer(a));
}

int find_attribute(const build &b, const tinygltf::Primitive &p, const std::string &name, const std::string &where)
{
    auto found = p.attributes.find(name);
    if (found == p.attributes.end())
        return -1;
    const tinygltf::Accessor &a = b.reader.info(found->second);
    if (!format_accepted(name, a, b.reader.components(found->second)))
        fail("%s.%s: accessors[%d] has a type that this attribute may not have", where.c_str(), name.c_str(), found->second);
    size_t wanted = b.reader.count(p.attributes.at("POSITION"));
    if (a.count != wanted)
        fail("%s.%s has %zu elements, POSITION has %zu", where.c_str(), name.c_str(), a.count, wanted);
    return found->second;
}

attribute_set find_attributes(const build &b, const tinygltf::Primitive &p, const std::string &where)
{
    attribute_set set;
    set.position = find_attribute(b, p, "POSITION", where);
    set.normal = find_attribute(b, p, "NORMAL", where);
    set.texcoord[0] = find_attribute(b, p, "TEXCOORD_0", where);
    set.texcoord[1] = find_attribute(b, p, "TEXCOORD_1", where);
    set.color = find_attribute(b, p, "COLOR_0", where);
    return set;
}

std::vector<uint32_t> read_indices(const build &b, const tinygltf::Primitive &p, size_t vertex_count, const std::string &where)
{
    std::vector<uint32_t> out;
    if (p.indices < 0) {
        out.resize(vertex_count);
        for (size_t i = 0; i < vertex_count; i++)
            out[i] = static_cast<uint32_t>(i);
        return out;
    }
    const tinygltf::Accessor &a = b.reader.info(p.indices);
    if (b.reader.components(p.indices) != 1 || (a.componentType != 5121 && a.componentType != 5123 && a.componentType != 5125))
        fail("%s.indices: accessors[%d] must hold unsigned integers (SCALAR of 5121, 5123 or 5125)", where.c_str(), p.indices);
    if (a.count > b.element_budget)
        fail("%s.indices has %zu elements, more than the file's size can justify", where.c_str(), a.count);
    out.resize(a.count);
    b.reader.read_indices(p.indices, out.data());
    uint32_t restart = a.componentType == 5121 ? 0xff : a.componentType == 5123 ? 0xffff : 0xffffffff;
    uint32_t most = 0;
    for (uint32_t i : out)
        most = std::max(most, i);
    if (most >= vertex_count)
        fail("%s.indices holds %u, but there are %zu vertices", where.c_str(), most, vertex_count);
    if (most == restart)
        fail("%s.indices holds %u, which is the primitive restart value", where.c_str(), most);
    return out;
}

/* glTF 3.7.2.1: strips turn over with each triangle, fans share their first vertex. */
std::vector<uint32_t> to_triangle_list(std::vector<uint32_t> in, int mode)
{
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        in.resize(in.size() / 3 * 3);
        return in;
    }
    std::vector<uint32_t> out;
    out.reserve(in.size() < 3 ? 0 : (in.size() - 2) * 3);
    for (size_t i = 0; i + 2 < in.size(); i++) {
        bool fan = mode == TINYGLTF_MODE_TRIANGLE_FAN;
        out.push_back(fan ? in[i + 1] : in[i]);
        out.push_back(fan ? in[i + 2] : in[i + 1 + i % 2]);
        out.push_back(fan ? in[0] : in[i + 2 - i % 2]);
    }
    return out;
}

void check_budget(const build &b, size_t stored, size_t more, const char *what)
{
    if (more > b.element_budget || stored > b.element_budget - more)
        fail("the file unfolds to more than %zu %s, which its size cannot justify", b.element_budget, what);
}

void normalize(float v[3])
{
    double x = v[0], y = v[1], z = v[2], length = std::sqrt(x * x + y * y + z * z);
    if (std::fabs(length - 1) < 1e-6)
        return;
    bool zero = !(length > 0);
    v[0] = zero ? 0 : static_cast<float>(x / length);
    v[1] = zero ? 0 : static_cast<float>(y / length);
    v[2] = zero ? 1 : static_cast<float>(z / length);
}

/* Flat normals of a list of unshared triangles; (0, 0, 1) where there is no area. */
void make_normals(const vec3f *positions, vec3f *normals, size_t count)
{
    for (size_t i = 0; i + 2 < count; i += 3) {
        const float *a = positions[i].v, *b = positions[i + 1].v, *c = positions[i + 2].v;
        struct dvec3 u = {double(b[0]) - a[0], double(b[1]) - a[1], double(b[2]) - a[2]};
        struct dvec3 w = {double(c[0]) - a[0], double(c[1]) - a[1], double(c[2]) - a[2]};
        struct dvec3 n = dvec3_normalize(dvec3_cross(u, w));
        bool flat = n.x != 0 || n.y != 0 || n.z != 0;
        vec3f normal = {{static_cast<float>(n.x), static_cast<float>(n.y), flat ? static_cast<float>(n.z) : 1}};
        normals[i] = normals[i + 1] = normals[i + 2] = normal;
    }
}

/* Reads `accessor` into the end of `to`: as it is, or one element per entry of `expand`. */
template <typename vec>
uint32_t append(build &b, pod_array<vec> &to, int accessor, const std::vector<uint32_t> *expand, const char *what)
{
    constexpr size_t width = sizeof(vec) / sizeof(float);
    size_t first = to.size(), count = b.reader.count(accessor);
    if (!expand) {
        b.reader.read_floats(accessor, to.extend(count)->v, width, what);
        return static_cast<uint32_t>(first);
    }
    std::vector<vec> all(count);
    b.reader.read_floats(accessor, all.data()->v, width, what);
    vec *out = to.extend(expand->size());
    for (size_t i = 0; i < expand->size(); i++)
        out[i] = all[(*expand)[i]];
    return static_cast<uint32_t>(first);
}

/* glTF 3.7.2.1: a COLOR_0 without alpha has 1. */
void finish_colors(build &b, uint32_t first, int accessor)
{
    bool opaque = b.reader.components(accessor) == 3;
    for (size_t i = first; i < b.colors.size(); i++)
        for (int k = 0; k < 4; k++)
            b.colors[i].v[k] = opaque && k == 3 ? 1 : std::min(std::max(b.colors[i].v[k], 0.0f), 1.0f);
}

vertex_range store_vertices(build &b, const attribute_set &set, const std::vector<uint32_t> &list, const std::string &where)
{
    vertex_range range = {};
    range.expanded = set.normal < 0;
    const std::vector<uint32_t> *expand = range.expanded ? &list : nullptr;
    size_t count = expand ? expand->size() : b.reader.count(set.position);
    check_budget(b, b.positions.size(), count, "vertices");
    range.count = static_cast<uint32_t>(count);
    range.first = append(b, b.positions, set.position, expand, (where + ".POSITION").c_str());
    if (set.normal >= 0) {
        append(b, b.normals, set.normal, nullptr, (where + ".NORMAL").c_str());
        for (size_t i = range.first; i < b.normals.size(); i++)
            normalize(b.normals[i].v);
    } else {
        b.normals.extend(count);
        make_normals(b.positions.data() + range.first, b.normals.data() + range.first, count);
    }
    for (int k = 0; k < 2; k++)
        range.texcoord[k] =
            set.texcoord[k] < 0 ? SCENE_NONE : append(b, b.texcoords, set.texcoord[k], expand, (where + ".TEXCOORD").c_str());
    range.color = SCENE_NONE;
    if (set.color >= 0) {
        range.color = append(b, b.colors, set.color, expand, (where + ".COLOR_0").c_str());
        finish_colors(b, range.color, set.color);
    }
    return range;
}

struct mesh make_mesh(build &b, const vertex_range &range, const std::vector<uint32_t> &list, int material)
{
    struct mesh mesh = {};
    check_budget(b, b.indices.size(), list.size(), "indices");
    mesh.first_vertex = range.first;
    mesh.vertex_count = range.count;
    mesh.first_index = static_cast<uint32_t>(b.indices.size());
    mesh.index_count = static_cast<uint32_t>(list.size());
    mesh.first_texcoord[0] = range.texcoord[0];
    mesh.first_texcoord[1] = range.texcoord[1];
    mesh.first_color = range.color;
    mesh.material = material < 0 ? static_cast<uint32_t>(b.materials.size() - 1) : static_cast<uint32_t>(material);
    uint32_t *out = b.indices.extend(list.size());
    for (size_t i = 0; i < list.size(); i++)
        out[i] = range.expanded ? static_cast<uint32_t>(i) : list[i];
    return mesh;
}

bool can_draw(build &b, const tinygltf::Primitive &p, const std::string &where)
{
    if (p.mode < TINYGLTF_MODE_TRIANGLES) {
        b.warn.add("%s holds points or lines and was left out", where.c_str());
        return false;
    }
    if (!p.attributes.count("POSITION")) {
        b.warn.add("%s has no POSITION and was left out", where.c_str());
        return false;
    }
    if (!p.targets.empty())
        b.warn.add("morph targets were ignored");
    return true;
}

/* The scene mesh of a primitive, SCENE_NONE if it cannot be drawn. */
uint32_t add_primitive(mesh_builder &mb, const tinygltf::Primitive &p, const std::string &name, const std::string &where)
{
    build &b = mb.b;
    if (!can_draw(b, p, where))
        return SCENE_NONE;
    attribute_set set = find_attributes(b, p, where);
    mesh_key key = {set.position, set.normal, set.texcoord[0], set.texcoord[1], set.color, p.indices, p.mode, p.material};
    auto known = mb.meshes.find(key);
    if (known != mb.meshes.end())
        return known->second;
    std::vector<uint32_t> list = to_triangle_list(read_indices(b, p, b.reader.count(set.position), where), p.mode);
    bool own = set.normal < 0;
    vertex_key vertices = {set.position, set.normal,           set.texcoord[0],  set.texcoord[1],
                           set.color,    own ? p.indices : -2, own ? p.mode : -2};
    auto stored = mb.vertices.find(vertices);
    if (stored == mb.vertices.end())
        stored = mb.vertices.emplace(vertices, store_vertices(b, set, list, where)).first;
    struct mesh mesh = make_mesh(b, stored->second, list, p.material);
    copy_name(mesh.name, sizeof mesh.name, name);
    uint32_t index = static_cast<uint32_t>(b.meshes.size());
    b.meshes.push(mesh);
    mb.meshes.emplace(key, index);
    return index;
}

} // namespace

void build_meshes(build &b)
{
    mesh_builder mb = {b, {}, {}};
    for (size_t m = 0; m < b.model.meshes.size(); m++) {
        const tinygltf::Mesh &from = b.model.meshes[m];
        std::vector<uint32_t> made;
        for (size_t p = 0; p < from.primitives.size(); p++) {
            std::string where = "meshes[" + std::to_string(m) + "].primitives[" + std::to_string(p) + "]";
            uint32_t mesh = add_primitive(mb, from.primitives[p], from.name, where);
            if (mesh != SCENE_NONE)
                made.push_back(mesh);
        }
        b.meshes_of.push_back(std::move(made));
    }
}

} // namespace gltf
