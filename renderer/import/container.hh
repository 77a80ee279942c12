/* The outside of a glTF file: JSON text, or a GLB of chunks (glTF 2.0, 4.4). */
#pragma once

#include "import/bytes.hh"

namespace gltf
{

class warnings;

struct container {
    span json;
    span bin;
    bool has_bin = false;
};

/* Borrows from `file`. */
container open_container(span file, warnings &warn);

} // namespace gltf
