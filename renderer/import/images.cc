#include "import/build.hh"
#include "import/failure.hh"
#include "import/folder.hh"

namespace gltf
{
namespace
{

/* All decoded pixels together: 1 GiB. */
constexpr uint64_t pixels_max = uint64_t{1} << 28;

const uint8_t ktx2_magic[] = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb};

/* Formats that only optional extensions name: their textures have another source, or none. */
bool is_unreadable_kind(const resource &image, span data)
{
    bool ktx2 = data.size >= sizeof ktx2_magic && memcmp(data.data, ktx2_magic, sizeof ktx2_magic) == 0;
    return ktx2 || image.mime == "image/ktx2" || image.mime == "image/avif" || image.mime == "image/vnd-ms.dds";
}

span image_bytes(build &b, const resource &image, const folder *where, const char *what, bytes &owned)
{
    if (image.has_uri == (image.buffer_view >= 0))
        fail("%s must have either a uri or a bufferView", what);
    if (image.buffer_view >= 0)
        return b.reader.view_bytes(image.buffer_view);
    if (is_data_uri(image.uri))
        owned = decode_data_uri(image.uri, what);
    else if (where)
        owned = where->read(image.uri, what, file_size_max);
    else
        fail("%s names a file, but the scene has no folder", what);
    return owned.view();
}

void add_image(build &b, size_t index, const folder *where, uint64_t *pixels)
{
    const resource &from = b.doc.images[index];
    std::string what = "images[" + std::to_string(index) + "]";
    if (from.has_uri && !is_data_uri(from.uri))
        what += " (" + from.uri.substr(0, 100) + ")";
    bytes owned;
    span data = image_bytes(b, from, where, what.c_str(), owned);
    if (is_unreadable_kind(from, data)) {
        b.warn.add("%s is of a kind that is not read and was left out", what.c_str());
        b.image_of.push_back(SCENE_NONE);
        return;
    }
    struct image image = {};
    struct error err = {};
    if (!image_decode(data.data, data.size, what.c_str(), &image, &err))
        fail_with(err.code, "%s", err.message);
    snprintf(image.name, sizeof image.name, "images[%zu]", index);
    b.image_of.push_back(static_cast<uint32_t>(b.images.size()));
    b.images.push(image);
    *pixels += static_cast<uint64_t>(image.width) * image.height;
    if (*pixels > pixels_max)
        fail("the images have more than %llu pixels together", static_cast<unsigned long long>(pixels_max));
}

} // namespace

void build_images(build &b, const folder *where)
{
    uint64_t pixels = 0;
    for (size_t i = 0; i < b.doc.images.size(); i++)
        add_image(b, i, where, &pixels);
}

} // namespace gltf
