/* A scene under construction. The steps, in order: images and materials, meshes, nodes. */
#pragma once

#include <string>
#include <vector>

#include "import/accessor.hh"
#include "import/bridge.hh"
#include "import/document.hh"
#include "import/warnings.hh"

namespace gltf
{

class folder;

struct vec2f {
    float v[2];
};
struct vec3f {
    float v[3];
};
struct vec4f {
    float v[4];
};

struct build {
    const document &doc;
    const tinygltf::Model &model;
    const accessor_reader &reader;
    warnings &warn;
    size_t element_budget; /* vertices, and indices, that may be stored: bounded by what the file's size can justify */

    pod_array<vec3f> positions, normals;
    pod_array<uint32_t> indices;
    pod_array<vec2f> texcoords;
    pod_array<vec4f> colors;
    pod_array<struct mesh> meshes;
    pod_array<struct instance> instances;
    pod_array<struct material> materials;
    pod_array<struct texture> textures;
    pod_array<struct image> images;
    pod_array<struct light> lights;
    pod_array<struct camera> cameras;

    std::vector<uint32_t> image_of;               /* per glTF image: scene image, SCENE_NONE if it was left out */
    std::vector<uint32_t> texture_of;             /* per glTF texture: scene texture or SCENE_NONE */
    std::vector<std::vector<uint32_t>> meshes_of; /* per glTF mesh: scene meshes */

    ~build();
};

/* `where` may be NULL: then files are refused. */
void build_images(build &b, const folder *where);
void build_materials(build &b);
void build_meshes(build &b);
void build_nodes(build &b);

/* Copies a name, cut at a character, control characters replaced. */
void copy_name(char *out, size_t size, const std::string &name);

} // namespace gltf
