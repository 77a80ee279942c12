#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <memory>

#include "import/bridge.hh"
#include "import/failure.hh"
#include "import/image_size.hh"
#include "import/oiio_threads.hh"

namespace
{

using gltf::fail;

constexpr int side_max = 16384;

struct format_entry {
    const char *magic;
    size_t length;
    const char *reader; /* OpenImageIO's name for it */
};

const format_entry formats[] = {{"\x89PNG\r\n\x1a\n", 8, "png"}, {"\xff\xd8\xff", 3, "jpeg"}, {"RIFF", 4, "webp"}};

const char *reader_for(const uint8_t *data, size_t size)
{
    for (const format_entry &f : formats)
        if (size >= f.length && memcmp(data, f.magic, f.length) == 0)
            return f.reader;
    return nullptr;
}

/* 1 to 4 channels, wherever they lie, to RGBA in place: `pixels` has room for four each. */
void spread_channels(uint8_t *pixels, size_t count, int channels)
{
    for (size_t i = count; i-- > 0;) {
        const uint8_t *from = pixels + i * static_cast<size_t>(channels);
        uint8_t rgba[4] = {from[0], from[channels > 2 ? 1 : 0], from[channels > 2 ? 2 : 0], 255};
        if (channels == 2 || channels == 4)
            rgba[3] = from[channels - 1];
        memcpy(pixels + 4 * i, rgba, 4);
    }
}

void check_size(const char *what, uint64_t width, uint64_t height)
{
    if (width < 1 || height < 1 || width > side_max || height > side_max)
        fail("%s has %llu x %llu pixels, 1 to %d a side are accepted", what, static_cast<unsigned long long>(width),
             static_cast<unsigned long long>(height), side_max);
}

struct decoding {
    const uint8_t *data;
    size_t size;
    const char *what;
    struct image *out;
};

void decode(void *context)
{
    decoding *d = static_cast<decoding *>(context);
    const char *name = reader_for(d->data, d->size);
    if (!name)
        fail("%s is no PNG, JPEG or WebP image", d->what);
    gltf::keep_oiio_to_one_thread();
    uint64_t width = 0, height = 0;
    if (gltf::find_image_size({d->data, d->size}, &width, &height))
        check_size(d->what, width, height);
    if (gltf::image_is_cut({d->data, d->size}))
        fail("%s is cut short", d->what);
    OIIO::Filesystem::IOMemReader memory(const_cast<uint8_t *>(d->data), d->size);
    std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(name);
    OIIO::ImageSpec config, spec;
    config["oiio:UnassociatedAlpha"] = 1;
    if (!input || !input->set_ioproxy(&memory) || !input->open(name, spec, config))
        fail("%s cannot be decoded: %.200s", d->what, input ? input->geterror().c_str() : OIIO::geterror().c_str());
    check_size(d->what, static_cast<uint64_t>(std::max(spec.width, 0)), static_cast<uint64_t>(std::max(spec.height, 0)));
    if (spec.nchannels < 1 || spec.nchannels > 4 || spec.depth > 1)
        fail("%s has %d channels, 1 to 4 are accepted", d->what, spec.nchannels);
    size_t count = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
    std::unique_ptr<uint8_t, void (*)(void *)> pixels(static_cast<uint8_t *>(malloc(count * 4)), free);
    if (!pixels)
        throw std::bad_alloc();
    int channels = spec.nchannels;
    if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, pixels.get()))
        fail("%s cannot be decoded: %.200s", d->what, input->geterror().c_str());
    if (channels < 4)
        spread_channels(pixels.get(), count, channels);
    d->out->width = static_cast<uint32_t>(spec.width);
    d->out->height = static_cast<uint32_t>(spec.height);
    d->out->rgba = pixels.release();
}

} // namespace

bool image_decode(const uint8_t *data, size_t size, const char *what, struct image *out, struct error *err)
{
    decoding d = {data, size, what, out};
    return gltf::guarded(err, decode, &d);
}
