#include <algorithm>
#include <cmath>

#include "import/build.hh"
#include "import/failure.hh"
#include "import/node_transform.hh"

namespace gltf
{
namespace
{

/* Far above any real scene; keeps a few bytes of instancing from filling the memory. */
constexpr size_t instances_max = size_t{1} << 22;

const tinygltf::Value *find(const tinygltf::ExtensionMap &extensions, const char *name)
{
    auto found = extensions.find(name);
    return found == extensions.end() ? nullptr : &found->second;
}

/* The nodes of one scene in depth-first order, with their world transforms. */
struct walk {
    std::vector<size_t> nodes;
    std::vector<struct affine> worlds;
};

/* glTF 3.5.2: nodes form strict trees. */
std::vector<bool> check_trees(const tinygltf::Model &model)
{
    std::vector<bool> has_parent(model.nodes.size(), false);
    for (size_t i = 0; i < model.nodes.size(); i++) {
        for (int child : model.nodes[i].children) {
            if (has_parent[static_cast<size_t>(child)])
                fail("nodes[%zu] is a child of nodes[%d] but has another parent too: a node may have one",
                     static_cast<size_t>(child), static_cast<int>(i));
            has_parent[static_cast<size_t>(child)] = true;
        }
    }
    /* With one parent each, what no root reaches lies on a cycle or below one. */
    std::vector<size_t> stack;
    size_t reached = 0;
    for (size_t i = 0; i < model.nodes.size(); i++)
        if (!has_parent[i])
            stack.push_back(i);
    while (!stack.empty()) {
        size_t node = stack.back();
        stack.pop_back();
        reached++;
        for (int child : model.nodes[node].children)
            stack.push_back(static_cast<size_t>(child));
    }
    if (reached != model.nodes.size())
        fail("nodes form a cycle: %zu of %zu can be reached from no root", model.nodes.size() - reached, model.nodes.size());
    return has_parent;
}

std::vector<size_t> roots_of_default_scene(build &b, const std::vector<bool> &has_parent)
{
    std::vector<size_t> roots;
    if (b.model.scenes.empty()) {
        for (size_t i = 0; i < has_parent.size(); i++)
            if (!has_parent[i])
                roots.push_back(i);
        b.warn.add("the file has no scene: all its nodes are drawn");
        return roots;
    }
    size_t scene = b.model.defaultScene < 0 ? 0 : static_cast<size_t>(b.model.defaultScene);
    std::vector<bool> seen(has_parent.size(), false);
    for (int node : b.model.scenes[scene].nodes) {
        size_t root = static_cast<size_t>(node);
        if (has_parent[root])
            fail("scenes[%zu] names nodes[%d], which is not a root", scene, node);
        if (seen[root])
            fail("scenes[%zu] names nodes[%d] twice", scene, node);
        seen[root] = true;
        roots.push_back(root);
    }
    return roots;
}

walk walk_scene(build &b)
{
    walk out;
    struct pending {
        size_t node;
        struct affine parent;
    };
    std::vector<size_t> roots = roots_of_default_scene(b, check_trees(b.model));
    std::vector<pending> stack;
    for (size_t i = roots.size(); i-- > 0;)
        stack.push_back({roots[i], affine_identity()});
    while (!stack.empty()) {
        pending at = stack.back();
        stack.pop_back();
        const tinygltf::Node &node = b.model.nodes[at.node];
        struct affine local = node_transform(node, at.node), world = affine_multiply(&at.parent, &local);
        if (!affine_finite(world))
            fail("nodes[%zu]: its world transform overflows", at.node);
        out.nodes.push_back(at.node);
        out.worlds.push_back(world);
        for (size_t i = node.children.size(); i-- > 0;)
            stack.push_back({static_cast<size_t>(node.children[i]), world});
    }
    return out;
}

void add_instances(build &b, int mesh, const struct affine &world)
{
    for (uint32_t part : b.meshes_of[static_cast<size_t>(mesh)]) {
        if (b.instances.size() >= instances_max)
            fail("the scene has more than %zu instances", instances_max);
        struct instance instance = {};
        instance.mesh = part;
        instance.to_scene = world;
        b.instances.push(instance);
    }
}

/* One attribute of EXT_mesh_gpu_instancing as floats; empty if absent. */
std::vector<float> instancing_attribute(build &b, const tinygltf::Value &attributes, const char *name, unsigned components,
                                        size_t *count, size_t node)
{
    std::vector<float> out;
    if (!attributes.Has(name))
        return out;
    int accessor = attributes.Get(name).GetNumberAsInt();
    size_t n = b.reader.count(accessor);
    std::string where = "nodes[" + std::to_string(node) + "].EXT_mesh_gpu_instancing." + name;
    if (b.reader.components(accessor) != components)
        fail("%s must have %u components", where.c_str(), components);
    if (*count != SIZE_MAX && n != *count)
        fail("%s has %zu elements, another attribute has %zu", where.c_str(), n, *count);
    if (n > instances_max)
        fail("%s has %zu elements, at most %zu are accepted", where.c_str(), n, instances_max);
    *count = n;
    out.resize(n * components);
    b.reader.read_floats(accessor, out.data(), components, where.c_str());
    return out;
}

void add_gpu_instances(build &b, const tinygltf::Value &extension, const tinygltf::Node &node, size_t index,
                       const struct affine &world)
{
    const tinygltf::Value &attributes = extension.Get("attributes");
    size_t count = SIZE_MAX;
    std::vector<float> t = instancing_attribute(b, attributes, "TRANSLATION", 3, &count, index);
    std::vector<float> r = instancing_attribute(b, attributes, "ROTATION", 4, &count, index);
    std::vector<float> s = instancing_attribute(b, attributes, "SCALE", 3, &count, index);
    for (size_t i = 0; count != SIZE_MAX && i < count; i++) {
        struct trs trs;
        for (size_t k = 0; k < 3; k++) {
            trs.translation[k] = t.empty() ? 0 : static_cast<double>(t[3 * i + k]);
            trs.scale[k] = s.empty() ? 1 : static_cast<double>(s[3 * i + k]);
        }
        for (size_t k = 0; k < 4; k++)
            trs.rotation[k] = r.empty() ? (k == 3) : static_cast<double>(r[4 * i + k]);
        struct affine local = trs_transform(trs, index), full = affine_multiply(&world, &local);
        if (!affine_finite(full))
            fail("nodes[%zu]: the world transform of an instance overflows", index);
        add_instances(b, node.mesh, full);
    }
}

enum light_kind light_kind_from(const std::string &type, size_t index)
{
    if (type == "directional")
        return LIGHT_DIRECTIONAL;
    if (type == "point")
        return LIGHT_POINT;
    if (type == "spot")
        return LIGHT_SPOT;
    fail("KHR_lights_punctual.lights[%zu].type is \"%.40s\", accepted are directional, point and spot", index, type.c_str());
}

struct light make_light(const tinygltf::Light &from, size_t index)
{
    struct light light = {};
    light.kind = light_kind_from(from.type, index);
    for (size_t k = 0; k < 3; k++)
        light.color[k] = k < from.color.size() ? static_cast<float>(from.color[k]) : 1;
    light.intensity = static_cast<float>(from.intensity);
    light.range = light.kind == LIGHT_DIRECTIONAL ? 0 : from.range;
    light.inner = from.spot.innerConeAngle;
    light.outer = light.kind == LIGHT_SPOT ? std::min(from.spot.outerConeAngle, M_PI / 2) : M_PI / 4;
    if (light.kind == LIGHT_SPOT && !(light.inner < light.outer))
        fail("KHR_lights_punctual.lights[%zu].spot: innerConeAngle %g must be less than outerConeAngle %g", index, light.inner,
             light.outer);
    if (light.kind == LIGHT_SPOT && from.spot.outerConeAngle > M_PI / 2 + 1e-6)
        fail("KHR_lights_punctual.lights[%zu].spot.outerConeAngle is %g, at most pi/2 is accepted", index,
             from.spot.outerConeAngle);
    if (!std::isfinite(light.intensity) || !std::isfinite(light.color[0] + light.color[1] + light.color[2]))
        fail("KHR_lights_punctual.lights[%zu] is too bright for single precision", index);
    return light;
}

void add_light(build &b, const tinygltf::Value &extension, const tinygltf::Node &node, const struct affine &world)
{
    size_t index = static_cast<size_t>(extension.Get("light").GetNumberAsInt());
    const tinygltf::Light &from = b.model.lights[index];
    struct light light = make_light(from, index);
    copy_name(light.name, sizeof light.name, from.name.empty() ? node.name : from.name);
    light.position = {world.offset[0], world.offset[1], world.offset[2]};
    light.direction = dvec3_normalize(affine_direction(&world, {0, 0, -1}));
    if (!(dvec3_length(light.direction) > 0.5)) {
        b.warn.add("the node of light \"%.60s\" has a scale of 0: the light points along -Z", light.name);
        light.direction = {0, 0, -1};
    }
    b.lights.push(light);
}

void set_axes(struct camera *camera, const struct affine &world)
{
    struct dvec3 back = dvec3_normalize(affine_direction(&world, {0, 0, 1}));
    struct dvec3 up = affine_direction(&world, {0, 1, 0});
    struct dvec3 right = dvec3_cross(up, back);
    if (!(dvec3_length(back) > 0.5) || !(dvec3_length(right) > 0)) {
        back = {0, 0, 1};
        right = {1, 0, 0};
    }
    camera->eye = {world.offset[0], world.offset[1], world.offset[2]};
    camera->back = back;
    camera->right = dvec3_normalize(right);
    camera->up = dvec3_cross(camera->back, camera->right);
}

void add_camera(build &b, const tinygltf::Node &node, const struct affine &world)
{
    const tinygltf::Camera &from = b.model.cameras[static_cast<size_t>(node.camera)];
    struct camera camera = {};
    copy_name(camera.name, sizeof camera.name, from.name.empty() ? node.name : from.name);
    set_axes(&camera, world);
    camera.orthographic = from.type == "orthographic";
    camera.yfov = M_PI / 4;
    camera.ymag = 1;
    if (camera.orthographic) {
        camera.ymag = std::fabs(from.orthographic.ymag);
        camera.near = from.orthographic.znear;
        camera.far = from.orthographic.zfar;
    } else {
        camera.yfov = from.perspective.yfov;
        camera.near = from.perspective.znear;
        camera.far = from.perspective.zfar > 0 ? from.perspective.zfar : static_cast<double>(INFINITY);
    }
    b.cameras.push(camera);
}

/* tinygltf has seen to it that the type is one of the two. */
void check_cameras(const tinygltf::Model &model)
{
    for (size_t i = 0; i < model.cameras.size(); i++) {
        const tinygltf::Camera &c = model.cameras[i];
        if (c.type == "orthographic") {
            if (c.orthographic.ymag == 0 || c.orthographic.xmag == 0)
                fail("cameras[%zu].orthographic: xmag and ymag must not be 0", i);
            if (!(c.orthographic.zfar > c.orthographic.znear))
                fail("cameras[%zu].orthographic: zfar %g must be greater than znear %g", i, c.orthographic.zfar,
                     c.orthographic.znear);
        } else {
            if (!(c.perspective.yfov > 0) || !(c.perspective.znear > 0))
                fail("cameras[%zu].perspective: yfov and znear must be greater than 0", i);
            if (c.perspective.zfar > 0 && !(c.perspective.zfar > c.perspective.znear))
                fail("cameras[%zu].perspective: zfar %g must be greater than znear %g", i, c.perspective.zfar,
                     c.perspective.znear);
        }
    }
}

void add_node(build &b, size_t index, const struct affine &world)
{
    const tinygltf::Node &node = b.model.nodes[index];
    const tinygltf::Value *instancing = find(node.extensions, "EXT_mesh_gpu_instancing");
    const tinygltf::Value *light = find(node.extensions, "KHR_lights_punctual");
    if (node.mesh >= 0 && instancing)
        add_gpu_instances(b, *instancing, node, index, world);
    else if (node.mesh >= 0)
        add_instances(b, node.mesh, world);
    if (light)
        add_light(b, *light, node, world);
    if (node.camera >= 0)
        add_camera(b, node, world);
}

} // namespace

void build_nodes(build &b)
{
    check_cameras(b.model);
    for (size_t i = 0; i < b.model.lights.size(); i++)
        make_light(b.model.lights[i], i);
    walk scene = walk_scene(b);
    for (size_t i = 0; i < scene.nodes.size(); i++)
        add_node(b, scene.nodes[i], scene.worlds[i]);
    if (b.instances.size() == 0)
        b.warn.add("the scene has nothing to draw");
}

} // namespace gltf
