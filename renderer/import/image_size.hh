/* The size that an image's header claims, read before any decoder is let near it. */
#pragma once

#include "import/bytes.hh"

namespace gltf
{

/* PNG (IHDR), JPEG (first SOF) and WebP (VP8, VP8L, VP8X); false if the header is not understood. */
bool find_image_size(span data, uint64_t *width, uint64_t *height);

/* True for a PNG whose chunks do not reach to an IEND within the data. Never handed to OpenImageIO 2.4: its read callback leaves libpng by
 * longjmp past a std::string, which is lost. */
bool image_is_cut(span data);

} // namespace gltf
