#include "import/container.hh"

#include "import/failure.hh"
#include "import/warnings.hh"

namespace gltf
{
namespace
{

constexpr uint32_t chunk_json = 0x4e4f534a, chunk_bin = 0x004e4942;

uint32_t word_at(span file, size_t offset)
{
    const uint8_t *p = file.data + offset;
    return p[0] | static_cast<uint32_t>(p[1]) << 8 | static_cast<uint32_t>(p[2]) << 16 | static_cast<uint32_t>(p[3]) << 24;
}

void check_header(span file, warnings &warn)
{
    if (file.size < 20)
        fail("the GLB file ends after %zu bytes, before its first chunk", file.size);
    if (word_at(file, 4) != 2)
        fail("the GLB file is of version %u, only version 2 is accepted", word_at(file, 4));
    if (word_at(file, 8) > file.size)
        fail("the GLB header says %u bytes, but the file has %zu: it is cut off or damaged", word_at(file, 8), file.size);
    if (word_at(file, 8) < file.size)
        warn.add("%zu bytes after the GLB's own end were ignored", file.size - word_at(file, 8));
}

void take_chunk(container &out, uint32_t type, span data, unsigned number)
{
    if ((number == 0) != (type == chunk_json))
        fail(number == 0 ? "the GLB's first chunk is not JSON" : "the GLB has a second JSON chunk");
    if (type == chunk_json) {
        out.json = data;
    } else if (type == chunk_bin) {
        if (number != 1)
            fail("the GLB's BIN chunk is number %u, it must be the second", number);
        out.bin = data;
        out.has_bin = true;
    }
}

} // namespace

container open_container(span file, warnings &warn)
{
    container out;
    if (file.size < 4 || memcmp(file.data, "glTF", 4) != 0) {
        out.json = file;
        return out;
    }
    check_header(file, warn);
    size_t end = word_at(file, 8), at = 12;
    for (unsigned number = 0; at < end; number++) {
        if (end - at < 8)
            fail("the GLB's chunk %u has a header cut off after %zu bytes", number, end - at);
        uint32_t length = word_at(file, at), type = word_at(file, at + 4);
        at += 8;
        if (length > end - at)
            fail("the GLB's chunk %u says %u bytes, but %zu are left", number, length, end - at);
        if (length % 4 != 0)
            warn.add("the GLB's chunk %u is not padded to a multiple of 4 bytes", number);
        take_chunk(out, type, {file.data + at, length}, number);
        at += length;
    }
    if (!out.json.data)
        fail("the GLB has no chunks");
    return out;
}

} // namespace gltf
