#include "import/image_size.hh"

namespace gltf
{
namespace
{

uint32_t big(const uint8_t *p, int n)
{
    uint32_t value = 0;
    for (int i = 0; i < n; i++)
        value = value << 8 | p[i];
    return value;
}

uint32_t little(const uint8_t *p, int n)
{
    uint32_t value = 0;
    for (int i = n - 1; i >= 0; i--)
        value = value << 8 | p[i];
    return value;
}

/* PNG specification, 5.2 and 11.2.2. */
bool png_size(span d, uint64_t *width, uint64_t *height)
{
    if (d.size < 24 || memcmp(d.data, "\x89PNG\r\n\x1a\n", 8) != 0)
        return false;
    *width = big(d.data + 16, 4);
    *height = big(d.data + 20, 4);
    return true;
}

/* ITU T.81, B.1 and B.2.2: markers up to the first start of frame. */
bool jpeg_size(span d, uint64_t *width, uint64_t *height)
{
    if (d.size < 2 || d.data[0] != 0xff || d.data[1] != 0xd8)
        return false;
    for (size_t at = 2; d.size - at >= 9 && d.data[at] == 0xff;) {
        uint8_t marker = d.data[at + 1];
        if (marker == 0xff) {
            at++;
            continue;
        }
        if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) {
            *height = big(d.data + at + 5, 2);
            *width = big(d.data + at + 7, 2);
            return true;
        }
        size_t length = 2 + static_cast<size_t>(big(d.data + at + 2, 2));
        if (length > d.size - at)
            return false;
        at += length;
    }
    return false;
}

/* RFC 9649, 2.5 to 2.7 and RFC 6386, 9.1. */
bool webp_size(span d, uint64_t *width, uint64_t *height)
{
    if (d.size < 30 || memcmp(d.data, "RIFF", 4) != 0 || memcmp(d.data + 8, "WEBP", 4) != 0)
        return false;
    if (memcmp(d.data + 12, "VP8X", 4) == 0) {
        *width = uint64_t{1} + little(d.data + 24, 3);
        *height = uint64_t{1} + little(d.data + 27, 3);
    } else if (memcmp(d.data + 12, "VP8L", 4) == 0) {
        uint32_t bits = little(d.data + 21, 4);
        *width = 1 + (bits & 0x3fff);
        *height = 1 + (bits >> 14 & 0x3fff);
    } else {
        *width = little(d.data + 26, 2) & 0x3fff;
        *height = little(d.data + 28, 2) & 0x3fff;
    }
    return true;
}

} // namespace

bool find_image_size(span data, uint64_t *width, uint64_t *height)
{
    return png_size(data, width, height) || jpeg_size(data, width, height) || webp_size(data, width, height);
}

/* PNG specification, 5.3: length, type, data, CRC. */
bool image_is_cut(span d)
{
    if (d.size < 8 || memcmp(d.data, "\x89PNG\r\n\x1a\n", 8) != 0)
        return false;
    for (size_t at = 8; d.size - at >= 12;) {
        size_t length = big(d.data + at, 4);
        if (length > d.size - at - 12)
            return true;
        if (memcmp(d.data + at + 4, "IEND", 4) == 0)
            return false;
        at += 12 + length;
    }
    return true;
}

} // namespace gltf
