#include <cstdio>
#include <memory>

#include "import/build.hh"
#include "import/container.hh"
#include "import/failure.hh"
#include "import/folder.hh"

namespace gltf
{

build::~build()
{
    for (size_t i = 0; i < images.size(); i++)
        free(images[i].rgba);
}

void copy_name(char *out, size_t size, const std::string &name)
{
    size_t length = name.size() < size - 1 ? name.size() : size - 1;
    while (length < name.size() && length > 0 && (static_cast<unsigned char>(name[length]) & 0xc0) == 0x80)
        length--;
    for (size_t i = 0; i < length; i++) {
        unsigned char c = static_cast<unsigned char>(name[i]);
        out[i] = c < 0x20 || c == 0x7f ? '?' : name[i];
    }
    out[length] = 0;
}

namespace
{

struct import {
    span file;
    const char *path; /* NULL: from memory */
    struct import_report *report;
    struct scene *scene;
};

/* Elements stored per byte of buffer, at most: a one-byte index in a strip makes three. The rest is room for small files. */
constexpr size_t elements_per_byte = 16, elements_least = size_t{1} << 20, elements_most = size_t{1} << 28;

/* The bytes of each buffer; `owned` keeps those that are not part of the file. */
std::vector<span> load_buffers(const document &doc, const container &file, const folder *where, std::vector<bytes> &owned)
{
    std::vector<span> out;
    uint64_t total = 0;
    for (size_t i = 0; i < doc.buffers.size(); i++) {
        const resource &buffer = doc.buffers[i];
        std::string what = "buffers[" + std::to_string(i) + "]";
        span data;
        bytes loaded;
        if (!buffer.has_uri && (i != 0 || !file.has_bin))
            fail("%s has no uri%s", what.c_str(), i == 0 ? ", and the file has no BIN chunk" : "");
        if (!buffer.has_uri)
            data = file.bin;
        else if (is_data_uri(buffer.uri))
            loaded = decode_data_uri(buffer.uri, what.c_str());
        else if (where)
            loaded = where->read(buffer.uri, what.c_str(), file_size_max);
        else
            fail("%s names a file, but the scene has no folder", what.c_str());
        if (buffer.has_uri)
            data = loaded.view();
        if (buffer.byte_length > data.size)
            fail("%s.byteLength is %llu, but there are %zu bytes", what.c_str(),
                 static_cast<unsigned long long>(buffer.byte_length), data.size);
        total += data.size;
        if (total > file_size_max)
            fail("the buffers have more than %llu bytes together", static_cast<unsigned long long>(file_size_max));
        data.size = static_cast<size_t>(buffer.byte_length);
        owned.push_back(std::move(loaded));
        out.push_back(data);
    }
    return out;
}

size_t element_budget(const std::vector<span> &buffers)
{
    size_t bytes = 0;
    for (const span &buffer : buffers)
        bytes += buffer.size;
    return std::min(elements_least + elements_per_byte * bytes, elements_most);
}

#define HAND_OVER(member, counter, from)                                             \
    do {                                                                             \
        scene->counter = (from).size();                                              \
        scene->member = reinterpret_cast<decltype(scene->member)>((from).release()); \
    } while (0)

struct scene *to_scene(build &b, const char *path)
{
    struct scene *scene = static_cast<struct scene *>(calloc(1, sizeof *scene));
    if (!scene)
        throw std::bad_alloc();
    const char *slash = path ? strrchr(path, '/') : nullptr;
    copy_name(scene->name, sizeof scene->name, !path ? "memory" : slash ? slash + 1 : path);
    HAND_OVER(positions, vertex_count, b.positions);
    HAND_OVER(normals, vertex_count, b.normals);
    HAND_OVER(indices, index_count, b.indices);
    HAND_OVER(texcoords, texcoord_count, b.texcoords);
    HAND_OVER(colors, color_count, b.colors);
    HAND_OVER(meshes, mesh_count, b.meshes);
    HAND_OVER(instances, instance_count, b.instances);
    HAND_OVER(materials, material_count, b.materials);
    HAND_OVER(textures, texture_count, b.textures);
    HAND_OVER(images, image_count, b.images);
    HAND_OVER(lights, light_count, b.lights);
    HAND_OVER(cameras, camera_count, b.cameras);
    return scene;
}

void run(void *context)
{
    import *in = static_cast<import *>(context);
    warnings warn;
    container file = open_container(in->file, warn);
    document doc;
    read_document(file.json, doc, warn);
    std::unique_ptr<folder> where(in->path ? new folder(in->path) : nullptr);
    std::vector<bytes> owned;
    std::vector<span> buffers = load_buffers(doc, file, where.get(), owned);
    accessor_reader reader(*doc.model, buffers);
    build b = {doc, *doc.model, reader, warn, element_budget(buffers)};
    build_images(b, where.get());
    build_materials(b);
    build_meshes(b);
    build_nodes(b);
    warn.hand_over(in->report, in->path ? in->path : "memory");
    in->scene = to_scene(b, in->path);
}

struct scene *finish(import *in, struct error *err)
{
    if (guarded(err, run, in) && scene_finish(in->scene, err))
        return in->scene;
    scene_destroy(in->scene);
    if (in->path && err->code != ERROR_NO_INPUT)
        error_prefix(err, "%s", in->path);
    return NULL;
}

struct reading {
    const char *path;
    bytes file;
};

void read_file(void *context)
{
    reading *r = static_cast<reading *>(context);
    r->file = read_scene_file(r->path);
}

} // namespace
} // namespace gltf

struct scene *import_gltf(const char *path, struct import_report *report, struct error *err)
{
    gltf::reading reading = {path, {}};
    if (!gltf::guarded(err, gltf::read_file, &reading))
        return NULL;
    gltf::import in = {reading.file.view(), path, report, NULL};
    return gltf::finish(&in, err);
}

struct scene *import_gltf_memory(const uint8_t *data, size_t size, struct import_report *report, struct error *err)
{
    gltf::import in = {{data, size}, NULL, report, NULL};
    return gltf::finish(&in, err);
}
