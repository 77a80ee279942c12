/* The size that an image's header claims, read before any decoder is let near it. */
#pragma once

#include "import/bytes.hh"

namespace gltf {

/* PNG (IHDR), JPEG (first SOF) and WebP (VP8, VP8L, VP8X); false if the header is not understood. */
bool find_image_size(span data, uint64_t *width, uint64_t *height);

} // namespace gltf
