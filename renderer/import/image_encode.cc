#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <memory>
#include <string>
#include <vector>

#include "import/bridge.hh"
#include "import/failure.hh"
#include "import/oiio_threads.hh"

namespace
{

using gltf::fail_with;

struct encoding {
    enum image_format format;
    const void *pixels;
    uint32_t width, height;
    int quality;
    const struct image_metadata *metadata;
    size_t metadata_count;
    uint8_t **out;
    size_t *size;
};

const char *const writers[] = {"png", "jpeg", "webp", "openexr"};

bool all_opaque(const encoding &e)
{
    const uint8_t *rgba = static_cast<const uint8_t *>(e.pixels);
    size_t count = static_cast<size_t>(e.width) * e.height;
    uint8_t least = 255;
    for (size_t i = 0; i < count; i++)
        least &= rgba[4 * i + 3];
    return least == 255;
}

/* JPEG has no alpha; the others keep it unless it says nothing. */
OIIO::ImageSpec make_spec(const encoding &e)
{
    bool exr = e.format == IMAGE_EXR;
    int channels = !exr && (e.format == IMAGE_JPEG || all_opaque(e)) ? 3 : 4;
    OIIO::ImageSpec spec(static_cast<int>(e.width), static_cast<int>(e.height), channels,
                         exr ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    spec["oiio:ColorSpace"] = exr ? "Linear" : "sRGB";
    if (exr) {
        spec["compression"] = "zip";
    } else {
        spec["oiio:UnassociatedAlpha"] = 1;
        spec["png:compressionLevel"] = 4;
        std::string quality = std::to_string(e.quality);
        if (e.format != IMAGE_PNG)
            spec["Compression"] = (e.format == IMAGE_JPEG ? "jpeg:" : "webp:") + quality;
        if (e.format == IMAGE_JPEG)
            spec["jpeg:subsampling"] = e.quality >= 90 ? "4:4:4" : "4:2:0";
    }
    for (size_t i = 0; i < e.metadata_count; i++)
        spec[e.metadata[i].key] = e.metadata[i].value;
    return spec;
}

void encode(void *context)
{
    encoding &e = *static_cast<encoding *>(context);
    gltf::keep_oiio_to_one_thread();
    std::vector<unsigned char> memory;
    OIIO::Filesystem::IOVecOutput sink(memory);
    const char *name = writers[e.format];
    std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(name);
    if (!output || !output->set_ioproxy(&sink))
        fail_with(ERROR_BUG, "this OpenImageIO cannot write %s to memory", name);
    OIIO::ImageSpec spec = make_spec(e);
    OIIO::stride_t pixel = e.format == IMAGE_EXR ? 4 * sizeof(float) : 4;
    if (!output->open(name, spec) || !output->write_image(spec.format, e.pixels, pixel, pixel * e.width) || !output->close())
        fail_with(ERROR_IO, "%s of %u x %u pixels cannot be encoded: %.200s", name, e.width, e.height,
                  output->geterror().c_str());
    *e.out = static_cast<uint8_t *>(malloc(memory.size() ? memory.size() : 1));
    if (!*e.out)
        throw std::bad_alloc();
    memcpy(*e.out, memory.data(), memory.size());
    *e.size = memory.size();
}

} // namespace

bool image_encode(enum image_format format, const void *pixels, uint32_t width, uint32_t height, int quality,
                  const struct image_metadata *metadata, size_t metadata_count, uint8_t **out, size_t *size, struct error *err)
{
    encoding e = {format, pixels, width, height, quality, metadata, metadata_count, out, size};
    return gltf::guarded(err, encode, &e);
}
